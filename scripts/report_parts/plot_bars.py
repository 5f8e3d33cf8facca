"""Bars that lie, each below its name: the value at the right, the interval as a thin line. A bar
may be a stack of parts."""
from . import svg
from .axes import Scale
from .tables import BASES, interval, is_measured, number
from .words import show, short, unit_of, with_interval

LEFT, RIGHT, STEP = 2, 430, 31


def is_the_default(row):
    return row["x"] in BASES and is_measured(row)


def bar(start, end, top, name, title=""):
    rest = f"><title>{svg.escape(title)}</title></rect>" if title else "/>"
    return (f'<rect class="bar{name}" x="{svg.place(start)}" y="{svg.place(top + 16)}" '
            f'width="{svg.place(max(end - start, 0.5))}" height="8"{rest}')


def look_of_part(number_of_part):
    """The classes of a part's segments: where colours repeat they are pale."""
    return f" part s{number_of_part % svg.SERIES}" + " pale" * (number_of_part >= svg.SERIES)


def segments(row, parts, scale, top):
    """Of medians, whose sum need not be the median of the whole."""
    shapes, end = [], 0.0
    for place, (column, name) in enumerate(parts):
        length = max(number(row.get(column)) or 0, 0)
        if length:
            shapes.append(bar(scale(end), scale(end + length), top, look_of_part(place),
                              f"{row['x']}, {name}: {show(length)} {unit_of(column)}"))
        end += length
    return shapes


def legend_of_parts(rows, parts, top):
    """A square and a name for each part that a row has: the SVG, and its height."""
    there = [(name, place) for place, (column, name) in enumerate(parts)
             if any(number(row.get(column)) for row in rows)]
    return svg.legend(there, LEFT, top, lambda place, x, y: (
        f'<rect class="bar{look_of_part(place)}" x="{svg.place(x)}" y="{svg.place(y - 8)}" '
        'width="9" height="8"/>'))


def draw_bar(row, value, scale, top, style):
    start, end = (scale(max(scale.low, 0) or scale.low), scale(value.middle))
    middle, unit = top + 20, unit_of(style["y"])
    shapes = segments(row, style.get("parts") or (), scale, top) or [bar(start, end, top, "")]
    if value.known:
        low, high = scale(value.low), scale(value.high)
        shapes += [svg.line(low, middle, high, middle, "interval"),
                   svg.line(low, middle - 3, low, middle + 3, "cap"),
                   svg.line(high, middle - 3, high, middle + 3, "cap")]
    shapes.append(svg.text(RIGHT, top + 11, show(value.middle), "value end"))
    tip = f"{row['x']}: {with_interval(value, unit, 4)}"
    return svg.point(value, tip, "default" if is_the_default(row) else "s0", shapes)


def draw_bars(rows, style, _all_series, ends):
    """The height and the content of a panel."""
    scale = Scale(*ends, style.get("log_y", False), LEFT, RIGHT)
    bottom = STEP * len(rows) + 4
    parts = []
    for value in scale.ticks():
        parts.append(svg.line(scale(value), 0, scale(value), bottom, "grid"))
        side = "start" if scale(value) < LEFT + 12 else "middle"
        parts.append(svg.text(scale(value), bottom + 14, short(value), f"tick {side}",
                              f' data-value="{value!r}"'))
    parts.append(svg.text((LEFT + RIGHT) / 2, bottom + 31, style.get("y_label", ""),
                          "axis middle"))
    mark = interval(rows[0], style["y"]).middle if is_the_default(rows[0]) else style.get("mark")
    if mark is not None and ends[0] <= mark <= ends[1]:
        parts.append(svg.line(scale(mark), 0, scale(mark), bottom, "mark"))
    for index, row in enumerate(rows):
        value = interval(row, style["y"]) if is_measured(row) else None
        parts.append(svg.text(LEFT, STEP * index + 11, row["x"], "name"))
        if value:
            parts.append(draw_bar(row, value, scale, STEP * index, style))
        else:
            parts.append(svg.text(LEFT, STEP * index + 24, row.get("status", ""), "note"))
    below, height = legend_of_parts(rows, style.get("parts") or (), bottom + 50)
    return bottom + 40 + (height + 10 if below else 0), "".join(parts) + below
