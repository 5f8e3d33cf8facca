"""Several devices: what the table of `scaling` says of them, beside what a simulation expected."""
from .html import html_table, paragraph, value_cell, verdict_cell
from .tables import in_groups, interval, number, unmeasured
from .words import listed, plain, show, with_interval

NOT_MEASURED = ("This was not measured: there is no table of scaling. On a machine with several "
                "GPUs scripts/reproduce --only scaling makes it.")
VERDICTS = {"as predicted": "quiet", "better than predicted": "good",
            "worse than predicted": "bad", "not known": "quiet", "not predicted": "quiet"}


def is_scaling(table):
    """Whether it has measurements; the table of simulated clusters has the same name."""
    return {"efficiency_median", "predicted"} <= set(table.columns)


def against_prediction(row):
    value, expected = interval(row, "efficiency"), number(row["predicted"])
    if expected is None:
        return "not predicted"
    if not value.known or value.low == value.high:
        return "not known"
    return ("worse than predicted" if value.high < expected else
            "better than predicted" if value.low > expected else "as predicted")


def of_several(table):
    """Rows with an efficiency, but for those that define it."""
    return [row for row in table.measured if interval(row, "efficiency")
            and (number(row["x"]) or 1) > 1]


def about_scaling(table):
    """[(panel, sentence)]: where each line ends."""
    for (panel, series), rows in in_groups(of_several(table), "panel", "series").items():
        parts = []
        for row in sorted(rows, key=lambda row: number(row["x"])):
            value, expected = interval(row, "efficiency"), number(row["predicted"])
            parts.append(f"{with_interval(value)} with {plain(number(row['x']))}"
                         + (f" (simulated {show(expected)}: {against_prediction(row)})"
                            if expected is not None else ""))
        yield f"{panel}, {series}", f"Efficiency against one device: {listed(parts)}."


def verdict_of(row):
    word = against_prediction(row)
    return verdict_cell(word, VERDICTS[word])


def several_devices(device):
    """An answer of the page's first section: strong scaling."""
    table = device.to_judge("scaling")
    rows = [row for row in of_several(table) if row["panel"] == "strong"] if (
        table and is_scaling(table)) else []
    if not rows:
        return paragraph(unmeasured(device, ["scaling"], NOT_MEASURED))
    lines = []
    for row in rows:
        wall, lost = number(row["wall_ms_median"]), number(row["outside_ms"])
        cells = [value_cell(interval(row, name)) for name in ("wall_ms", "efficiency")]
        lines.append([f"{plain(number(row['x']))} {row['series']}", *cells, row["predicted"],
                      verdict_of(row), f"{100 * lost / wall:.1f} %"])
    scene = listed(dict.fromkeys(f"{row['scene']}, {row['width']}x{row['height']}, {row['spp']} "
                                 f"samples" for row in rows))
    return paragraph(
        f"One image ({scene}) rendered by more and more devices of one machine. The efficiency is "
        "one device's wall time over that of all together, times their number. The simulation "
        "knows the rule by which pixels are divided, but not this scene: it takes the median over "
        "several maps of what pixels cost.") + html_table(
            ["devices", "wall time, ms", "efficiency", "simulated", "verdict",
             "outside of kernels"], lines, caption="Strong scaling")
