"""Two devices: the rows that both have, side by side."""
import math

from .answers import ratio_cell, time_cell
from .html import html_table, paragraph, verdict_cell
from .tables import interval
from .words import change, quotient, show


def rows_by_name(table, column):
    found = {}
    for row in table.measured:
        name = row.get("name") or ", ".join(row[label] for label in ("panel", "x") if row.get(label))
        if name and interval(row, column):
            found[name] = interval(row, column)
    return found


def side_by_side(names, tables, column):
    """`names` and `tables` of two devices; a sentence and a table."""
    first, second = (rows_by_name(table, column) for table in tables)
    common = [name for name in first if name in second]
    if not common:
        return paragraph("The two devices have no configuration in common here.")
    lines, logs, counts = [], [], {}
    for name in common:
        word, ratio = change(first[name], second[name])
        counts[word] = counts.get(word, 0) + 1
        logs.append(math.log(ratio))
        lines.append([name, time_cell(first[name]), time_cell(second[name]),
                      ratio_cell(quotient(second[name], first[name])), verdict_cell(word)])
    mean = math.exp(sum(logs) / len(logs))
    text = (f"Over {len(common)} configurations that both measured, {names[1]} takes "
            f"{show(mean)} times the time of {names[0]} (geometric mean; from "
            f"{show(math.exp(min(logs)))} to {show(math.exp(max(logs)))}). It is "
            + ", ".join(f"{word} in {count}" if word in ("faster", "slower") else
                        f"without a significant difference in {count}"
                        if word == "no significant difference" else f"not judged in {count}"
                        for word, count in counts.items()) + ".")
    heads = ["configuration", *(f"{name}, ms" for name in names), "time ratio", names[1] + " is"]
    return paragraph(text) + html_table(heads, lines)
