"""A map of the table `sizes`: which mode is faster for which scene, size, samples and depth, by how
much, and what --mode auto loses there."""
from html import escape
from math import log2

from .html import Cell, html_table, paragraph
from .tables import number
from .words import show

NOT_MEASURED = "This was not measured: there is no table sizes."
MODES = ("megakernel", "wavefront")
DEEPEST = 60  # per cent of a colour, where a mode takes four times as long as the other


def tint(ratio):
    """The class of the faster mode's colour, and how deep it is."""
    share = DEEPEST * min(abs(log2(ratio)) / 2, 1)
    return MODES[ratio > 1], f"--share:{share:.0f}%"


def cells_of(table):
    """{(scene, depth, samples): {size: {variant: row}}}"""
    cells = {}
    for row in table.measured:
        place = row["panel"], int(row["max_depth"]), int(row["spp"])
        cells.setdefault(place, {}).setdefault(int(row["width"]), {})[row["variant"]] = row
    return cells


def map_cell(rows):
    times = [number(rows.get(mode, {}).get("kernel_ms_median")) for mode in MODES]
    if None in times:
        return Cell("<td></td>")
    ratio = times[0] / times[1]
    title = ", ".join(f"{mode} {show(time)} ms" for mode, time in zip(MODES, times))
    auto = rows.get("auto")
    if auto and number(auto.get("loss")) is not None:
        title += (f"; auto takes {auto.get('used_mode') or 'one of them'}, "
                  f"loses {max(number(auto['loss']), 0):.1%}")
    mode, share = tint(ratio)
    return Cell(f'<td class="n {mode}" data-v="{ratio!r}" title="{escape(title)}" style="{share}">'
                f"{show(ratio)}</td>")


def size_map(device):
    table = device.to_judge("sizes")
    if not table or not table.measured:
        return paragraph(NOT_MEASURED)
    cells = cells_of(table)
    sizes = sorted({size for by_size in cells.values() for size in by_size})
    rows = [[f"{scene}, depth {depth}, {samples} sample{'s' if samples > 1 else ''}",
             *(map_cell(by_size.get(size, {})) for size in sizes)]
            for (scene, depth, samples), by_size in cells.items()]
    return (paragraph("The megakernel's time divided by the wavefront's: green where the wavefront "
                      "is faster, red where the megakernel is. "
                      + " ".join(f"{line[0].upper()}{line[1:]}." for line in
                                 table.facts.get("conclusions", [])))
            + html_table(["scene", *(f"{size} x {size}" for size in sizes)], rows,
                         caption="Megakernel / wavefront by image size"))
