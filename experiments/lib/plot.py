"""Draws a table of an experiment: NAME.csv, with the NAME.json beside it, as NAME.png.

A marker is the median of the repeats, a bar its 95 % interval (in tables without one, from the
fastest repeat to the slowest). The colours
(Okabe and Ito 2008, 'Color Universal Design') and the markers tell the series apart, each alone.
"""
from pathlib import Path

import matplotlib

matplotlib.use("Agg")  # draws into files, needs no screen
from matplotlib import pyplot, ticker  # noqa: E402  pylint: disable=wrong-import-position

from lib.sentences import BASES, plot_title, short  # noqa: E402  pylint: disable=wrong-import-position
from lib.table import read_facts, read_rows  # noqa: E402  pylint: disable=wrong-import-position

COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#000000", "#56B4E9", "#E69F00"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X"]
COLUMNS = 3  # panels side by side
MISSING = ["refused", "failed", "pending"]  # what a row without a value may say
TICKS = 12  # more places on the axis than these, measured times say, have no ticks of their own


def in_groups(rows, label):
    """{value of the label: its rows}, in the order of the table."""
    groups = {}
    for row in rows:
        groups.setdefault(row.get(label, ""), []).append(row)
    return groups


def spread(rows, column):
    """Medians, and the lengths of the bars below and above them: none for a single value."""
    median = f"{column}_median" if f"{column}_median" in rows[0] else column
    middle = [float(row[median]) for row in rows]
    has_interval = all(row.get(f"{column}_low") for row in rows)
    if median == column and not has_interval:
        return middle, None
    low, high = ([float(row[f"{column}_{part}"]) for row in rows]
                 for part in (("low", "high") if has_interval else ("min", "max")))
    return middle, [[m - l for m, l in zip(middle, low)], [h - m for m, h in zip(middle, high)]]


def drawable(rows, column):
    """The measured rows that have the value: a table that was cut off lacks some."""
    return [row for row in rows if row["status"] == "measured"
            and (row.get(f"{column}_median") or row.get(column))]


def label_times(axis):
    """A logarithmic axis of milliseconds with plain numbers: 1, 2, 5, 10 ..."""
    axis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5), numticks=30))
    axis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:,g}"))
    axis.set_minor_locator(ticker.NullLocator())


def draw_lines(axes, rows, style):
    for series, members in in_groups(rows, "series").items():
        number = style["series"].index(series)
        colour, marker = number % len(COLOURS), (number + number // len(COLOURS)) % len(MARKERS)
        look = {"color": COLOURS[colour], "marker": MARKERS[marker]}
        measured = sorted(drawable(members, style["y"]), key=lambda row: float(row["x"]))
        if measured:
            medians, bars = spread(measured, style["y"])
            axes.errorbar([float(row["x"]) for row in measured], medians, bars, label=series,
                          capsize=3, linewidth=1.2, markersize=5, **look)
        targets = [row for row in members if row.get("target_ms")]
        axes.scatter([float(row["x"]) for row in targets],
                     [float(row["target_ms"]) for row in targets], marker="_", s=300,
                     color=look["color"], label=f"{series}: target" if targets else None)
    missing = {float(row["x"]): row["status"] for row in rows if row["status"] in MISSING}
    for x, status in sorted(missing.items()):
        axes.axvline(x, color="grey", linestyle=":", linewidth=1)
        axes.text(x, 0.98, f"{status} ", rotation=90, ha="right", va="top", color="grey",
                  transform=axes.get_xaxis_transform())
    ticks = sorted({float(row["x"]) for row in rows})
    axes.set_xscale("log" if ticks[0] > 0 else "linear")
    axes.set_xlabel(style["x_label"])
    if len(ticks) <= TICKS:
        axes.set_xticks(ticks, [short(tick) for tick in ticks], rotation=30, ha="right")
        axes.xaxis.set_minor_locator(ticker.NullLocator())
    else:
        label_times(axes.xaxis)
    axes.set_ylabel(style["y_label"])
    if style["log_y"]:
        axes.set_yscale("log")
        label_times(axes.yaxis)
    if style.get("mark") is not None:
        axes.axhline(style["mark"], color=COLOURS[4], linestyle="--", linewidth=1)
    if not axes.get_legend_handles_labels()[0]:
        return  # nothing is measured yet
    if len(style["series"]) <= len(COLOURS):
        axes.legend(fontsize="small")
    else:
        axes.legend(fontsize="small", loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2)


def draw_points(axes, rows, style):
    """Both axes have the same unit; the diagonal is where they agree."""
    draw_lines(axes, rows, style)
    for bars in axes.containers:
        bars.lines[0].set_linestyle("")
    axes.set_xscale("linear")
    axes.set_yscale("linear")
    ends = axes.get_xlim()
    axes.plot(ends, ends, color=COLOURS[4], linewidth=0.8)
    axes.set_xlim(ends)


def places_of(rows):
    return {row["name"]: -place for place, row in enumerate(rows)}  # the first one on top


def name_bars(axes, rows, style):
    places = places_of(rows)
    for row in rows:
        if row["status"] in MISSING:
            axes.text(0, places[row["name"]], f" {row['status']}", va="center", color="grey",
                      transform=axes.get_yaxis_transform())
    axes.set_yticks(list(places.values()), [row["x"] for row in rows])
    axes.set_xlabel(style["y_label"])
    if style["log_y"]:
        axes.set_xscale("log")
        label_times(axes.xaxis)


def draw_bars(axes, rows, style):
    measured, places = drawable(rows, style["y"]), places_of(rows)
    if measured:
        medians, bars = spread(measured, style["y"])
        axes.barh([places[row["name"]] for row in measured], medians, xerr=bars, capsize=3,
                  color=COLOURS[5], edgecolor=COLOURS[0])
        if measured[0]["x"] in BASES:
            axes.axvline(medians[0], color=COLOURS[4], linestyle="--", linewidth=1)
    name_bars(axes, rows, style)


def draw_stack(axes, rows, style):
    """Segments are medians, whose sum need not be that of the whole, which has the marker."""
    measured, places, ends = drawable(rows, style["y"]), places_of(rows), {}
    for number, (column, name) in enumerate(style["parts"]):
        mine = [row["name"] for row in measured if row.get(column)]
        widths = [max(float(row[column]), 0) for row in measured if row.get(column)]
        if mine:
            axes.barh([places[row] for row in mine], widths, left=[ends.get(row, 0) for row in mine],
                      color=COLOURS[number % len(COLOURS)], edgecolor="white", linewidth=0,
                      hatch="///" * (number // len(COLOURS)), label=name)
        ends.update((row, ends.get(row, 0) + width) for row, width in zip(mine, widths))
    if measured:
        medians, bars = spread(measured, style["y"])
        axes.errorbar(medians, [places[row["name"]] for row in measured], xerr=bars, fmt="d",
                      color=COLOURS[4], markersize=4, capsize=3, linewidth=1.2, label="whole")
    name_bars(axes, rows, style)
    axes.set_ylim(0.6 - len(rows), 0.6)
    axes.figure.legend(fontsize="small", loc="outside lower center", ncols=6)


def draw(path):
    """Draws the table at `path`; returns the path of the picture."""
    path = Path(path)
    facts = read_facts(path)
    rows = [row for row in read_rows(path) if row["x"]]  # without x: not for the picture
    if not rows:
        raise ValueError("no row has its place in the picture yet: is the table complete?")
    style = {**facts["plot"], "series": list(in_groups(rows, "series"))}
    panels = in_groups(rows, "panel")
    bars = max(map(len, panels.values())) if style["kind"] not in ("lines", "points") else 0
    height = max(4.8, 0.3 * bars)
    if style["kind"] == "lines" and len(style["series"]) > len(COLOURS):
        height += 0.11 * len(style["series"])  # the legend is below
    columns = min(len(panels), COLUMNS)
    width = 9.6 if style["kind"] == "stack" else 6.4
    lines = -(-len(panels) // columns)
    figure, all_axes = pyplot.subplots(lines, columns, squeeze=False, layout="constrained",
                                       figsize=(width * columns, lines * height))
    for axes in all_axes.flat[len(panels):]:
        axes.set_visible(False)
    for axes, (panel, members) in zip(all_axes.flat, panels.items()):
        {"lines": draw_lines, "points": draw_points, "bars": draw_bars, "stack": draw_stack}[style["kind"]](
            axes, members, {**style, "x_label": style["x_label"] or panel})
        axes.set_title(panel, fontsize="medium")
        axes.grid(True, axis="both" if style["kind"] == "lines" else "x", alpha=0.3)
    figure.suptitle(f"{plot_title(facts)}\n{facts['device']['name']}, {facts['host']['cpu']}",
                    fontsize="medium")
    picture = path.with_suffix(".png")
    figure.savefig(picture, dpi=130, metadata={"Software": None})
    pyplot.close(figure)
    return picture
