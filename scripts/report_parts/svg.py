"""Pieces of SVG that both kinds of plot share. Classes carry the look (plot.css)."""
import re
from html import escape

WIDTH = 440  # units of a panel; text has 11, so that a telephone shows it at 9 pixels
SERIES = 7
MARKERS = ["M-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0z", "M-3.5-3.5h7v7h-7z", "M0-4.6L4.4 3.4H-4.4z",
           "M0-5L4.4 0L0 5L-4.4 0z", "M0 4.6L4.4-3.4H-4.4z",
           "M-4.4-1.4h3v-3h2.8v3h3v2.8h-3v3h-2.8v-3h-3z", "M-4-2L-2-4L4 2L2 4z"]


def place(value):
    return f"{value:.2f}".rstrip("0").rstrip(".")


def line(x1, y1, x2, y2, name):
    return (f'<line class="{name}" x1="{place(x1)}" y1="{place(y1)}" x2="{place(x2)}" '
            f'y2="{place(y2)}"/>')


def text(x, y, words, name, more=""):
    return f'<text class="{name}" x="{place(x)}" y="{place(y)}"{more}>{escape(words)}</text>'


def text_width(words):
    """At most, in units of a panel."""
    return 6.6 * len(words)


def look(number):
    """The classes of a series, and its marker's outline."""
    return f"s{number % SERIES}", MARKERS[(number + number // SERIES) % len(MARKERS)]


def point(value, tip, name, shapes, more=""):
    """A measured value: what is shown of it, and its numbers for the reader and for tests. `more`
    are attributes."""
    ends = (f' data-low="{value.low!r}" data-high="{value.high!r}"' if value.known else "")
    return (f'<g class="point {name}" data-middle="{value.middle!r}"{ends}{more}>'
            f"<title>{escape(tip)}</title>{''.join(shapes)}</g>")


def marker_sign(number, x, y):
    colour, marker = look(number)
    return (f'<path class="marker {colour}" transform="translate({place(x + 5)} '
            f'{place(y - 4)})" d="{marker}"/>')


def legend(series, left, top, sign=marker_sign):
    """The names of the series in lines below a plot: the SVG, and its height. `sign` draws a
    series' sign by its number."""
    parts, x, y = [], left, top
    for name, number in series:
        needed = 24 + 6.1 * len(name)
        if x > left and x + needed > WIDTH:
            x, y = left, y + 17
        parts.append(sign(number, x, y))
        parts.append(text(x + 14, y, name, "legend"))
        x += needed
    return "".join(parts), y - top + 17


def for_daylight(style):
    """The style without variables and without darkness: programs that convert SVG know neither."""
    first = style.partition("@media")[0]
    values = dict(re.findall(r"(--\w+): ([^;]+);", first))
    rules = first[:first.index("{")] + "{" + first[first.index("font-family"):] + style.rpartition(
        "\n}\n")[2]
    return re.sub(r"var\((--\w+)\)", lambda match: values[match[1]], rules)


def standing_alone(title, panels, style):
    """One SVG file of (title, height, content), in two columns where there are several."""
    columns = 2 if len(panels) > 1 else 1
    parts, top = [text(14, 26, title, "title")], 44
    for first in range(0, len(panels), columns):
        row = panels[first:first + columns]
        for column, (name, _, content) in enumerate(row):
            parts.append(f'<g transform="translate({14 + column * (WIDTH + 24)} {place(top)})">'
                         f'{text(0, 12, name, "panel")}<g transform="translate(0 20)">{content}'
                         "</g></g>")
        top += 40 + max(height for _, height, _ in row)
    width = 28 + columns * WIDTH + (columns - 1) * 24
    return (f'<svg xmlns="http://www.w3.org/2000/svg" class="plot" viewBox="0 0 {width} '
            f'{place(top)}" width="{width}" height="{place(top)}">'
            f"<style>{for_daylight(style)}</style>"
            f'<rect class="paper" width="{width}" height="{place(top)}"/>{"".join(parts)}</svg>\n')
