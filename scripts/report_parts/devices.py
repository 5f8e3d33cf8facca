"""Two devices: the rows that both have, side by side."""
import math

from .html import html_table, paragraph, value_cell, verdict_cell
from .tables import interval
from .words import change, quotient, show


WORK = ("scene", "width", "height", "spp", "max_depth", "ray_file", "rays")


def rows_by_name(table, column):
    """{name: (what was to be computed, value)}"""
    found = {}
    for row in table.measured:
        name = row.get("name") or ", ".join(filter(None, (row.get("panel"), row.get("x"))))
        if name and interval(row, column):
            found[name] = tuple(row.get(label, "") for label in WORK), interval(row, column)
    return found


def side_by_side(names, tables, column):
    """`names` and `tables` of two devices; a sentence and a table."""
    first, second = (rows_by_name(table, column) for table in tables)
    both = [name for name in first if name in second]
    common = [name for name in both if first[name][0] == second[name][0]]
    others = (f" {len(both) - len(common)} more have equal names but other images or rays, and are "
              "not compared." if len(both) > len(common) else "")
    if not common:
        return paragraph("The two devices have no configuration in common here." + others)
    lines, logs, counts = [], [], {}
    for name in common:
        a, b = first[name][1], second[name][1]
        word, ratio = change(a, b)
        counts[word] = counts.get(word, 0) + 1
        logs.append(math.log(ratio))
        lines.append([name, value_cell(a), value_cell(b), value_cell(quotient(b, a)),
                      verdict_cell(word)])
    mean = math.exp(sum(logs) / len(logs))
    text = (f"Over {len(common)} configurations that both measured, {names[1]} takes "
            f"{show(mean)} times the time of {names[0]} (geometric mean; from "
            f"{show(math.exp(min(logs)))} to {show(math.exp(max(logs)))}). It is "
            + ", ".join(f"{word} in {count}" for word, count in counts.items()) + "." + others)
    heads = ["configuration", *(f"{name}, ms" for name in names), "time ratio", names[1] + " is"]
    return paragraph(text) + html_table(heads, lines, caption=f"{tables[0].name}: {names[0]} and {names[1]}")
