"""Lines over a logarithmic axis: a marker for each value, a bar for its interval."""
from . import svg
from .axes import Scale
from .tables import in_groups, interval, is_measured, number
from .words import plain, short, show, unit_of, with_interval

LEFT, RIGHT, TOP, BOTTOM = 50, 426, 24, 262
MOST_TICKS = 12


def grid(x_scale, y_scale, style, places):
    parts = [svg.text(0, 10, style.get("y_label", ""), "axis"),
             svg.line(LEFT, BOTTOM, RIGHT, BOTTOM, "base")]
    for value in y_scale.ticks():
        parts.append(svg.line(LEFT, y_scale(value), RIGHT, y_scale(value), "grid"))
        parts.append(svg.text(LEFT - 7, y_scale(value) + 3.6, short(value), "tick y",
                              f' data-value="{value!r}"'))
    end = -100  # of the last label
    for value in places if len(places) <= MOST_TICKS else x_scale.ticks():
        here = x_scale(value)
        parts.append(svg.line(here, BOTTOM, here, BOTTOM + 4, "base"))
        half = svg.text_width(short(value)) / 2
        if here - half > end + 4:
            parts.append(svg.text(here, BOTTOM + 16, short(value), "tick x"))
            end = here + half
    parts.append(svg.text((LEFT + RIGHT) / 2, BOTTOM + 33, style.get("x_label", ""),
                          "axis middle"))
    return parts


def draw_point(here, y_scale, value, tip, number_of_series):
    colour, marker = svg.look(number_of_series)
    shapes = []
    if value.known:
        low, high = y_scale(value.low), y_scale(value.high)
        shapes = [svg.line(here, low, here, high, "interval"),
                  svg.line(here - 3, low, here + 3, low, "cap"),
                  svg.line(here - 3, high, here + 3, high, "cap")]
    shapes.append(f'<path class="marker" transform="translate({svg.place(here)} '
                  f'{svg.place(y_scale(value.middle))})" d="{marker}"/>')
    return svg.point(value, tip, colour, shapes)


def scale_over(places):
    """With some air; a logarithm, unless there is a place that has none."""
    low, high = places[0], places[-1]
    if low <= 0:
        air = 0.05 * (high - low) or 1
        return Scale(low - air, high + air, False, LEFT, RIGHT)
    air = 1.0 + 0.06 * max(1, len(places)) if low == high else (high / low) ** 0.05
    return Scale(low / air, high * air, True, LEFT, RIGHT)


def draw_lines(rows, style, all_series, ends):
    """The height and the content of a panel."""
    places = sorted({number(row["x"]) for row in rows} - {None}) or [1]
    x_scale = scale_over(places)
    y_scale = Scale(*ends, style.get("log_y", False), BOTTOM, TOP)
    parts = grid(x_scale, y_scale, style, places)
    if style.get("mark") is not None and ends[0] <= style["mark"] <= ends[1]:
        parts.append(svg.line(LEFT, y_scale(style["mark"]), RIGHT, y_scale(style["mark"]), "mark"))
    if style["kind"] == "points":  # the diagonal, where both axes agree
        low, high = max(places[0], ends[0]), min(places[-1], ends[1])
        parts.append(svg.line(x_scale(low), y_scale(low), x_scale(high), y_scale(high), "mark"))
    unit, names = unit_of(style["y"]), []
    for series, members in in_groups(rows, "series").items():
        index = all_series.index(series)
        found = sorted(((number(row["x"]), interval(row, style["y"])) for row in members
                        if is_measured(row) and number(row["x"]) is not None),
                       key=lambda pair: pair[0])
        found = [(x, value) for x, value in found if value]
        if not found:
            continue
        names.append((series, index))
        if style["kind"] == "lines":
            track = " ".join(f"{svg.place(x_scale(x))},{svg.place(y_scale(value.middle))}"
                             for x, value in found)
            parts.append(f'<polyline class="line s{index % svg.SERIES}" points="{track}"/>')
        name = series or style["y_label"]
        parts += [draw_point(x_scale(x), y_scale, value, f"{name}, {plain(x)} "
                             f"{style.get('x_label', '')}: {with_interval(value, unit, 4)}", index)
                  for x, value in found]
        for row in members:
            target = number(row.get("target_ms"))
            if target and ends[0] <= target <= ends[1]:
                here = x_scale(number(row["x"]))
                dash = svg.line(here - 9, y_scale(target), here + 9, y_scale(target), "target")
                parts.append(f'<g class="s{index % svg.SERIES}"><title>{svg.escape(series)}: '
                             f"target {show(target)} ms</title>{dash}</g>")
    refused = {(number(row["x"]), row["status"]) for row in rows if not is_measured(row)
               and number(row["x"]) is not None}
    for x, status in sorted(refused):
        parts.append(svg.line(x_scale(x), TOP, x_scale(x), BOTTOM, "refused"))
        parts.append(svg.text(x_scale(x) - 4, TOP + 10, status, "note end"))
    below, height = svg.legend([pair for pair in names if pair[0]], LEFT, BOTTOM + 54)
    return BOTTOM + 40 + height, "".join(parts) + below
