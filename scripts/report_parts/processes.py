"""Whole processes: what the table of `process_time` says of their wall time and its parts."""
from .html import Cell, html_table, paragraph, value_cell, verdict_cell
from .tables import in_groups, interval, number, unmeasured
from .words import listed, show

NOT_MEASURED = "This was not measured: there is no table of process_time."
VERDICTS = {"pass": "good", "MISS": "bad"}
LARGEST = 3  # parts that the answer names


def is_processes(table):
    return bool(table.plot and table.plot["kind"] == "stack")


def shares(table, row):
    """[(share of the wall time, part)], the largest first."""
    wall = interval(row, table.plot["y"]).middle
    found = [((number(row.get(column)) or 0) / wall, name) for column, name in table.plot["parts"]]
    return sorted(found, reverse=True)


def percent(share):
    return f"{100 * share:.0f} %"


def renders(table):
    """Rows of processes that have rendered a scene: their time is divided."""
    return [row for row in table.measured if number(row.get("kernel_ms_median"))]


def about_processes(table):
    """[(panel, sentence)]: which part is the largest, and where."""
    rows = renders(table)
    first = in_groups([{"name": shares(table, row)[0][1], "x": row["x"],
                        "share": shares(table, row)[0][0]} for row in rows], "name")
    for name, mine in sorted(first.items(), key=lambda group: -len(group[1])):
        yield "", (f"{name[:1].upper()}{name[1:]}: the largest part of {len(mine)} of {len(rows)} "
                   "processes, " + listed(f"{row['x']} ({percent(row['share'])})" for row in mine)
                   + ".")


def whole_processes(device):
    """An answer of the page's first section."""
    table = device.to_judge("process_time")
    rows = renders(table) if table and is_processes(table) else []
    if not rows:
        return paragraph(unmeasured(device, ["process_time"], NOT_MEASURED))
    lines = []
    for row in rows:
        largest = [f"{name} {percent(share)}" for share, name in shares(table, row)[:LARGEST]]
        verdict = row.get("verdict", "")
        lines.append([row["x"], value_cell(interval(row, table.plot["y"])),
                      value_cell(interval(row, "kernel_ms")), ", ".join(largest),
                      row.get("over_ms", ""), row.get("goal_ms", ""),
                      verdict_cell(verdict, VERDICTS.get(verdict, "quiet")) if verdict else
                      Cell("<td></td>")])
    others = [f"{row['x']} {show(interval(row, table.plot['y']).middle)} ms"
              for row in table.measured if row not in rows]
    return paragraph(
        "From the start of a process to its end, with the picture written, by default options "
        "or with the builder of trees that is named. "
        + (f"For comparison: {listed(others)}. " if others else "")
        + "The excess is the wall time without kernels and without an empty CUDA program."
    ) + html_table(["process", "wall time, ms", "kernels, ms", "largest parts", "excess, ms",
                    "goal, ms", "verdict"], lines, caption="Whole processes")
