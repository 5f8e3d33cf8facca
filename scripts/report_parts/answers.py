"""The first section: which mode for my scene, which block size, what does each idea give."""
from html import escape

from .html import Cell, html_table, paragraph, value_cell, verdict_cell
from .processes import whole_processes
from .scaling import several_devices
from .size_map import size_map
from .tables import in_groups, interval, number
from .words import change, quotient, relation, show

NOT_MEASURED = "This was not measured: there is no table {}."


def way(row):
    return row.get("x") if row.get("panel") else row.get("way") or row.get("x", "")


def scene_rows(device):
    """(table, scene, commit, rows of one image): the megakernel's rows and the wavefront's."""
    for name in ("image_size", "defaults", "scenes", "shading", "dial"):
        table = device.to_judge(name)
        groups, kinds = {}, {row.get("device_kind") for row in table.measured} if table else ()
        kind = "cuda" if "cuda" in kinds else "cpu"
        for row in table.measured if table else []:
            if name == "image_size":
                if row.get("device_kind", kind) != kind:
                    continue
                scene = f"spheres, {row['width']}x{row['height']}"
            elif name == "dial":
                if number(row["materials"]) not in (1, 32) or row["coherence"] != "0":
                    continue
                scene = f"dial, {row['figure']}, {row['materials']} materials"
            else:
                scene = row.get("panel") or row["scene"]
            groups.setdefault((scene, row.get("commit", "")), []).append(row)
        for (scene, commit), rows in groups.items():
            yield name, scene, commit, rows


def best_of(rows, mode):
    found = [(interval(row, "kernel_ms"), row) for row in rows if (
        row.get("mode") or ("megakernel" if way(row) == "megakernel" else "wavefront")) == mode]
    return min(((value, row) for value, row in found if value),
               key=lambda pair: pair[0].middle, default=None)


def which_mode(device):
    lines, winners = [], {}
    for name, scene, commit, rows in scene_rows(device):
        mega, wave = best_of(rows, "megakernel"), best_of(rows, "wavefront")
        if not (mega and wave):
            continue
        ratio = quotient(mega[0], wave[0])
        winner = {"overlap": "no significant difference", "apart": "", "unknown": ""}[
            relation(mega[0], wave[0])] or ("wavefront" if ratio.middle > 1 else "megakernel")
        unsure = relation(mega[0], wave[0]) == "unknown"
        winners.setdefault(winner + (", by values without a spread" if unsure else ""),
                           []).append(scene)
        lines.append([scene, value_cell(mega[0]), value_cell(wave[0]), value_cell(ratio),
                      winner + (" (no spread known)" if unsure else ""), name, commit[:7]])
    if not lines:
        return paragraph(NOT_MEASURED.format("with both modes in it (image_size, defaults, scenes, "
                                             "shading, dial)"))
    parts = [f"{word}: {'; '.join(dict.fromkeys(scenes))}." for word, scenes in winners.items()]
    return (paragraph("The faster one, each with its fastest options measured. "
                      + " ".join(part[0].upper() + part[1:] for part in parts))
            + html_table(["scene", "megakernel, ms", "wavefront, ms", "megakernel / wavefront",
                          "faster", "table", "commit"], lines,
                         caption="Fastest times of both modes, scene by scene"))


def commit_of(table):
    return "commit " + ", ".join(commit[:7] for commit in table.commits)


def which_block(device):
    table = device.to_judge("block_size")
    if not table or not table.measured:
        return paragraph(NOT_MEASURED.format("block_size"))
    lines, losses = [], {}
    for (panel, series), rows in in_groups(table.measured, "panel", "series").items():
        pairs = [(row["x"], interval(row, "kernel_ms")) for row in rows]
        pairs = sorted((pair for pair in pairs if pair[1]), key=lambda pair: pair[1].middle)
        (best, least), (worst, most) = pairs[0], pairs[-1]
        equal = [x for x, value in pairs[1:] if relation(least, value) == "overlap"]
        for x, value in pairs:
            losses.setdefault(x, []).append(value.middle / least.middle)
        lines.append([panel, series, best, value_cell(least),
                      Cell(f"<td>{escape(', '.join(equal) or 'none')}</td>"),
                      f"{worst} (x{show(most.middle / least.middle)})"])
    everywhere = {x: max(values) for x, values in losses.items() if len(values) == len(lines)}
    text = "No size was measured in every way of executing."
    if everywhere:
        choice = min(everywhere, key=everywhere.get)
        bad = max(everywhere, key=everywhere.get)
        text = (f"Take {choice} threads: over the {len(lines)} cases they take at most "
                f"{show(everywhere[choice])} times as long as the best size of the case. "
                f"{bad} threads take up to {show(everywhere[bad])} times as long.")
    return paragraph(text) + html_table(
        ["image", "execution", "best, threads", "kernel time, ms", "no significant difference",
         "worst, threads"], lines, caption=f"Block sizes ({commit_of(table)})")


def effect(idea, where, default, value, source):
    word, ratio = change(default, value)
    return [idea, where, value_cell(quotient(value, default), repr(ratio)), verdict_cell(word),
            source]


def steps(device):
    """Each step of the ladder against the one before it."""
    table = device.to_judge("ladder")
    for scene, rows in (in_groups(table.measured, "panel").items() if table else ()):
        for before, row in zip(rows, rows[1:]):
            yield effect(f"step {row['x']}", f"{scene}, after {before['x']}",
                         interval(before, "kernel_ms"), interval(row, "kernel_ms"), "ladder")


# table, label of the choice, the choice, what it is compared with, labels of equal rows
COMPARED = (("random_numbers", "x", "XORWOW", "Philox", ("panel",)),
            ("random_numbers", "x", "Sobol, kernels for all scenes",
             "Philox, kernels for all scenes", ("panel",)),
            ("pool_size", "series", "regenerated", "filled when empty", ("panel", "pool")),
            ("scene_memory", "series", "constant", "global", ("panel", "x")),
            ("scene_memory", "series", "shared", "global", ("panel", "x")))


def against_others(device):
    for name, label, choice, base, places in COMPARED:
        table = device.to_judge(name)
        for row in table.measured if table else ():
            other = next((one for one in table.measured if one[label] == base
                          and all(one[place] == row[place] for place in places)), None)
            if row[label] == choice and other:
                unit = {"scene_memory": " spheres", "pool_size": " paths"}.get(name, "")
                where = ", ".join(row[place] for place in places) + unit
                yield effect(f"{choice}, against {base}", where, interval(other, "kernel_ms"),
                             interval(row, "kernel_ms"), name)


def effects(device):
    table = device.to_judge("toggles")
    for mode, rows in (in_groups(table.measured, "panel").items() if table else ()):
        default = next((interval(row, "kernel_ms") for row in rows if row["x"] == "default"), None)
        for row in rows if default else ():
            value = interval(row, "kernel_ms")
            if row["x"] != "default" and value:
                yield effect(row["x"], mode, default, value, "toggles")
    yield from steps(device)
    yield from against_others(device)
    for name, scene, _commit, rows in scene_rows(device):
        if name not in ("shading", "dial"):
            continue
        ways = {row["variant"] if name == "dial" else way(row): interval(row, "kernel_ms")
                for row in rows}
        for new, idea in (("uber, sorted", "surfaces in order of their kinds"),
                          ("by material", "a kernel for each kind")):
            if ways.get("uber") and ways.get(new):
                yield effect(idea, scene, ways["uber"], ways[new], name)


def each_idea(device):
    lines = list(effects(device))
    if not lines:
        return paragraph(NOT_MEASURED.format("of toggles, ladder, shading or dial"))
    return paragraph("Time with the choice, divided by the time without it (of the mode's "
                     "defaults; of one kernel over unordered surfaces for shading; of the step "
                     "before it for the ladder): above 1 the "
                     "choice costs, below 1 it gains. The interval follows from the extremes of "
                     "both.") + html_table(
                         ["choice", "where", "time ratio", "verdict", "table"], lines,
                             caption="Each choice against its lack; commits are said at the tables")


QUESTIONS = (("Which mode for my scene?", which_mode),
             ("And for which size, samples and depth?", size_map),
             ("Which block size?", which_block),
             ("What does each idea give?", each_idea),
             ("Where does the time of a whole process go?", whole_processes),
             ("What do several devices give?", several_devices))
