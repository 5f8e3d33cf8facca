"""The plot of a table: one panel for each value of the label `panel`."""
from . import axes, svg
from .plot_bars import draw_bars
from .plot_lines import draw_lines
from .tables import in_groups, interval, is_measured, plot_title, style_of


def values_of(rows, table):
    return [value for row in rows if is_measured(row)
            for value in [interval(row, table.plot["y"])] if value]


def domains(tables):
    """{panel: lowest and highest place}: the same for the tables of several devices."""
    found = {}
    for table in tables:
        for panel, rows in in_groups(table.drawn, "panel").items():
            found.setdefault(panel, []).extend(values_of(rows, table))
    log = tables[0].plot.get("log_y", False)
    return {panel: axes.domain(values, log) for panel, values in found.items() if values}


def draw_panels(table, shared=None):
    """[(panel, height, content)]"""
    shared = shared or domains([table])
    series = list(in_groups(table.drawn, "series"))
    draw = draw_lines if table.plot["kind"] in ("lines", "points") else draw_bars
    return [(panel, *draw(rows, style_of(table, panel), series, shared[panel]))
            for panel, rows in in_groups(table.drawn, "panel").items() if panel in shared]


def in_page(height, content, label):
    return (f'<svg class="plot" role="img" aria-label="{svg.escape(label)}" viewBox="0 0 '
            f'{svg.WIDTH} {svg.place(height)}">{content}</svg>')


def title_of(table):
    return plot_title(table.facts) or table.name
