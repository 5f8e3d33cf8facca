"""The page's first screen, made from modes.verdicts: the answer in words, the map, the limits; and
below them the table of scenes."""
from html import escape
from math import exp, log
from statistics import mean

from . import svg
from .axes import Scale
from .html import (Cell, html_table, paragraph, value_cell, verdict_cell, work_attributes)
from .modes import ANSWERING, MODES, one_for_each_scene, silent, verdicts
from .tables import unmeasured
from .words import listed, short, show, with_interval

MOST_WORDS = 120
MOST_NAMES = 5
AUTO = "--mode auto"
NOT_MEASURED = ("This was not measured: there is no complete table of defaults, sizes or scenes "
                "with both modes in it.")
LEFT, RIGHT, TOP, LINE = 152, 424, 14, 15.5


def percent(share):
    return f"{100 * share:.1f}\u00a0%" if share >= 0.001 or not share else "below 0.1\u00a0%"


def how_many(found, word):
    """In how many scenes the wavefront is `word`, and where it is most so."""
    mine = [verdict for verdict in found if verdict.word == word]
    text = f"{word} in {len(mine)}"
    if not mine or word not in ("faster", "slower"):
        return text
    most = max(mine, key=lambda verdict: abs(log(verdict.ratio.middle)))
    ratio = max(most.ratio.middle, 1 / most.ratio.middle)
    return f"{text} (up to {show(ratio)} times, {most.work.scene})"


def mean_change(found, label, values):
    """The geometric mean of the wavefront's gain from the one value of a work's label to the other,
    all else equal; None without such pairs."""
    def others(work):
        return tuple(getattr(work, name) for name in ("scene", "size", "spp", "depth")
                     if name != label)
    ends = [{others(work): verdict.ratio.middle for work, verdict in found.items()
             if getattr(work, label) == value} for value in values]
    logs = [log(ends[1][key] / ends[0][key]) for key in ends[0] if key in ends[1]]
    return exp(mean(logs)) if logs else None


def effects_of(found):
    """What depth and size do, where auto was measured: there the images are a grid."""
    grid = [work for work, verdict in found.items() if verdict.auto]
    parts = []
    for label, words, key in (("depth", "depth {1} instead of {0}", lambda work: work.depth),
                              ("size", "{1} pixels instead of {0}",
                               lambda work: work.width * work.height)):
        ends = [getattr(end(grid, key=key), label) for end in (min, max)] if grid else ["", ""]
        gain = mean_change({work: found[work] for work in grid}, label, ends)
        if ends[0] != ends[1] and gain:
            ratio = "" if parts else "multiplies the ratio megakernel / wavefront "
            parts.append(f"{words.format(*ends)} {ratio}by {show(gain)}")
    text = listed(parts)
    return f"{text[:1].upper()}{text[1:]} (geometric means)." if parts else ""


def about_auto(found):
    known = [verdict for verdict in found.values() if verdict.loss is not None]
    if not known:
        return f"What {AUTO} takes was not measured."
    wrong = sum(verdict.loss > 0 for verdict in known)
    fixed = [mean(verdict.loss_of(mode) for verdict in known) for mode in MODES]
    most = max(verdict.loss for verdict in known)
    advice = f"Leave the choice to {AUTO}" if mean(
        verdict.loss for verdict in known) <= min(fixed) else "Name the mode"
    return (f"{advice}: of {len(known)} images, auto took the slower mode in {wrong}"
            + (f" and lost at most {percent(most)}" if wrong else "")
            + f"; always the wavefront would lose {percent(fixed[1])} on average, always the "
              f"megakernel {percent(fixed[0])}.")


def answer_text(device):
    """At most MOST_WORDS words; sentences that do not fit are left out, from the end."""
    found = verdicts(device)
    if not found:
        return unmeasured(device, ANSWERING, NOT_MEASURED)
    scenes = one_for_each_scene(found)
    counts = [how_many(scenes, word) for word in ("faster", "slower", "same", "ambiguous")
              if any(one.word == word for one in scenes)]
    slower = [verdict.work.scene for verdict in scenes if verdict.word == "slower"]
    sentences = [f"It depends on the scene. Of {len(scenes)} scenes, the wavefront is "
                 f"{listed(counts)}, each mode with its fastest options measured.",
                 f"The megakernel wins {listed(slower)}." if 0 < len(slower) <= MOST_NAMES else "",
                 about_auto(found), effects_of(found)]
    while sum(len(one.split()) for one in sentences) > MOST_WORDS:
        sentences.pop()
    return " ".join(filter(None, sentences))


def marks(found):
    """The series of the map: each size and depth, small images first."""
    return list(dict.fromkeys(f"{work.size}, depth {work.depth}" for work in sorted(
        found, key=lambda work: (work.width * work.height, work.depth))))


def draw_map(found):
    """(height, content): a line for each scene in the order of the table, a point for each work."""
    scenes = [verdict.work.scene for verdict in one_for_each_scene(found)]
    bottom = TOP + LINE * len(scenes)
    ratios = [verdict.ratio for verdict in found.values()]
    ends = [end for ratio in ratios for end in (ratio.low or ratio.middle,
                                                ratio.high or ratio.middle)] + [1]
    scale = Scale(min(ends) / 1.06, max(ends) * 1.06, True, LEFT, RIGHT)
    parts = [svg.line(LEFT, bottom, RIGHT, bottom, "base"),
             svg.line(scale(1), TOP - 6, scale(1), bottom, "mark"),
             svg.text(scale(1) - 5, TOP - 4, "megakernel faster", "axis end"),
             svg.text(scale(1) + 5, TOP - 4, "wavefront faster", "axis")]
    for value in scale.ticks():
        parts += [svg.line(scale(value), bottom, scale(value), bottom + 4, "base"),
                  svg.text(scale(value), bottom + 16, short(value), "tick x",
                           f' data-value="{value!r}"')]
    series = marks(found)
    for number, scene in enumerate(scenes):
        y = TOP + LINE * (number + 0.6)
        parts += [svg.line(LEFT, y, RIGHT, y, "grid"), svg.text(LEFT - 8, y + 3.6, scene, "name end")]
        for work, verdict in found.items():
            if work.scene == scene:
                index = series.index(f"{work.size}, depth {work.depth}")
                parts.append(draw_point(scale, y, verdict, index))
    parts.append(svg.text((LEFT + RIGHT) / 2, bottom + 31, "time of the megakernel / time of the "
                          "wavefront", "axis middle"))
    below, height = svg.legend([(name, index) for index, name in enumerate(series)], 4, bottom + 52)
    return bottom + 40 + height, "".join(parts) + below


def draw_point(scale, y, verdict, index):
    ratio = verdict.ratio
    colour, marker = svg.look(index)
    shapes = [svg.line(scale(ratio.low), y, scale(ratio.high), y, "interval")] if ratio.known else []
    shapes.append(f'<path class="marker" transform="translate({svg.place(scale(ratio.middle))} '
                  f'{svg.place(y)})" d="{marker}"/>')
    times = ", ".join(with_interval(verdict.times[mode][0], "ms", 4).join((f"{mode} ", ""))
                      for mode in MODES)
    return svg.point(ratio, f"{verdict.work}: {with_interval(ratio)}; {times}", colour, shapes,
                     ratio_attributes(verdict))


def ratio_attributes(verdict):
    """What a test reads to see that the page says one thing of a work."""
    return (f' data-work="{escape(str(verdict.work))}" data-how="ratio" '
            f'data-word="{verdict.word}"')


def mode_map(found):
    if not found:
        return ""
    height, content = draw_map(found)
    return ('<figure class="map">' + f'<svg class="plot" role="img" aria-label="The ratio of the '
            f'modes by scene" viewBox="0 0 {svg.WIDTH} {svg.place(height)}">{content}</svg>'
            "<figcaption>A line is a scene, a point one image: right of the dashed line the wavefront "
            "is faster, and colour and shape say image size and depth.</figcaption></figure>")


def drivers(table):
    """Of the JSON's list of GPUs: a line of heads, then a line for each GPU."""
    heads, *lines = [line.split(", ") for line in table.facts.get("gpus") or [""]]
    return [dict(zip(heads, line)).get("driver_version", "") for line in lines]


def limits(device):
    """[(what, text)]"""
    found = verdicts(device)
    if not found:
        return []
    tables = list({verdict.table.name: verdict.table for verdict in found.values()}.values())
    rows = [row for verdict in found.values() for _, row in verdict.times.values()]
    said = [("device", {row.get("device_name") for row in rows}),
            ("driver", {driver for table in tables for driver in drivers(table)}),
            ("CUDA", {row.get("cuda") for row in rows}),
            ("commit", {verdict.commit for verdict in found.values()}),
            ("tables", {f"{table.name}.csv" for table in tables}),
            ("date", {table.facts.get("date", "")[:10] for table in tables}),
            ("images", {work.size for work in found}),
            ("samples", {str(work.spp) for work in found}),
            ("depths", {str(work.depth) for work in found})]
    pairs = [(name, ", ".join(sorted(filter(None, values), key=lambda text: (len(text), text))))
             for name, values in said]
    unknown = [verdict.work.scene for verdict in one_for_each_scene(found)
               if not any(one.auto for work, one in found.items()
                          if work.scene == verdict.work.scene)]
    missing = ["other devices", "other sizes, samples and depths"] + (
        [f"what auto takes in {len(unknown)} scenes"] if unknown else [])
    quiet = len(silent(device))
    return pairs + [("not measured", listed(missing)), ("left out", f"{quiet} tables; the end of the "
                                                        "page says why" if quiet else "")]


def auto_cell(found, scene):
    """The modes that auto took, each with its number of works, and what that lost at most."""
    taken = [(work, verdict) for work, verdict in found.items()
             if work.scene == scene and verdict.auto]
    if not taken:
        return Cell("<td>not measured</td>")
    modes = [verdict.auto.get("used_mode", "") for _, verdict in taken]
    counts = [f"{mode} {modes.count(mode)}" for mode in dict.fromkeys(modes)]
    lost = max(verdict.loss or 0 for _, verdict in taken)
    return Cell(f"<td>{escape(', '.join(counts) + (f'; loses {percent(lost)}' if lost else ''))}</td>")


def time_cell(verdict, mode):
    value, row = verdict.times[mode]
    return value_cell(value, row["kernel_ms_median"], 3,
                      work_attributes(verdict.table, row, "kernel_ms_median"))


def scene_table(device):
    found = verdicts(device)
    if not found:
        return paragraph(unmeasured(device, ANSWERING, NOT_MEASURED))
    commits = {verdict.commit for verdict in found.values()}
    rows = [[verdict.work.scene, verdict.work.size, str(verdict.work.spp), str(verdict.work.depth),
             *(time_cell(verdict, mode) for mode in MODES),
             value_cell(verdict.ratio, more=ratio_attributes(verdict)), verdict_cell(verdict.word),
             auto_cell(found, verdict.work.scene),
             verdict.table.name + (f", {verdict.commit}" if len(commits) > 1 else "")]
            for verdict in one_for_each_scene(found)]
    return html_table(["scene", "image", "samples", "depth", "best megakernel, ms",
                       "best wavefront, ms", "megakernel / wavefront", "wavefront is",
                       "auto takes, images", "table"], rows, "scenes",
                      f"Both modes, scene by scene (commit {listed(sorted(commits))}). Auto: in how "
                      "many images of the map it takes which mode, and what it loses at most")
