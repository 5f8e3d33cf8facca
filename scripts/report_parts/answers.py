"""Causes and other answers: what each choice gives, which block size, processes, several devices."""
from html import escape
from typing import NamedTuple

from .html import Cell, html_table, paragraph, value_cell, verdict_cell
from .processes import whole_processes
from .scaling import several_devices
from .tables import BASES, Interval, in_groups, interval, unmeasured
from .words import change, listed, quotient, relation, show

MOST_NAMED = 4
NOT_MEASURED = "This was not measured: there is no table {}."


def commit_of(table):
    return "commit " + ", ".join(commit[:7] for commit in table.commits)


def which_block(device):
    table = device.to_judge("block_size")
    if not table or not table.measured:
        return paragraph(unmeasured(device, ["block_size"], NOT_MEASURED.format("block_size")))
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


class Effect(NamedTuple):
    """A choice, where it was measured, the times without and with it, and the table."""
    idea: str
    where: str
    default: Interval
    value: Interval
    table: str

    @property
    def ratio(self):
        return self.value.middle / self.default.middle

    @property
    def word(self):
        return change(self.default, self.value)[0]

    @property
    def cells(self):
        return [self.idea, self.where, value_cell(quotient(self.value, self.default),
                                                  repr(self.ratio)), verdict_cell(self.word), self.table]


def steps(device):
    """Each step of the ladder against the one before it."""
    table = device.to_judge("ladder")
    for scene, rows in (in_groups(table.measured, "panel").items() if table else ()):
        for before, row in zip(rows, rows[1:]):
            yield Effect(f"step {row['x']}", f"{scene}, after {before['x']}",
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
                yield Effect(f"{choice}, against {base}", where, interval(other, "kernel_ms"),
                             interval(row, "kernel_ms"), name)


def effects(device):
    table = device.to_judge("toggles")
    for mode, rows in (in_groups(table.measured, "panel").items() if table else ()):
        default = next((interval(row, "kernel_ms") for row in rows if row["x"] in BASES), None)
        for row in rows if default else ():
            value = interval(row, "kernel_ms")
            if row["x"] not in BASES and value:
                yield Effect(row["x"], mode, default, value, "toggles")
    yield from steps(device)
    yield from against_others(device)
    for scene, rows, name in orders(device):
        ways = {row["variant"] if name == "dial" else row["x"]: interval(row, "kernel_ms")
                for row in rows}
        for new, idea in (("uber, sorted", "surfaces in order of their kinds"),
                          ("by material", "a kernel for each kind")):
            if ways.get("uber") and ways.get(new):
                yield Effect(idea, scene, ways["uber"], ways[new], name)


def orders(device):
    """(scene, rows, table): ways to order surfaces, and the ends of the dial of materials."""
    for name in ("shading", "dial"):
        table = device.to_judge(name)
        for row_group in in_groups(table.measured, "panel" if name == "shading" else "scene"
                                   ).values() if table else ():
            first = row_group[0]
            if name == "shading":
                yield first["panel"], row_group, name
            elif first["coherence"] == "0" and first["materials"] in ("1", "32"):
                yield f"dial, {first['figure']}, {first['materials']} materials", row_group, name


def largest(found, word):
    """The choices that are `word` by the largest factors, each once. A ladder starts from kernels that
    do less than the one before it: its costs are no choice."""
    chosen = {}
    for effect in sorted(found, key=lambda one: one.ratio, reverse=word == "slower"):
        if effect.word == word and (word == "faster" or effect.table != "ladder"):
            chosen.setdefault(effect.idea, effect)
    return listed(f"{effect.idea} ({effect.where}, x{show(effect.ratio)})"
                  for effect in list(chosen.values())[:MOST_NAMED])


def each_idea(device):
    found = list(effects(device))
    if not found:
        return paragraph(unmeasured(device, ["toggles", "ladder", "shading", "dial"],
                                    NOT_MEASURED.format("of toggles, ladder, shading or dial")))
    table = device.to_judge("toggles")
    named = {row["x"] for row in table.measured} if table else ()
    base = " or ".join(name for name in BASES if name in named) or BASES[0]
    ends = [f"{start}: {largest(found, word)}." for start, word in (
        ("The largest gains", "faster"), ("The largest costs", "slower")) if largest(found, word)]
    return paragraph(" ".join(ends)) + paragraph(
        f"Time with the choice, divided by the time without it (of the row {base} for toggles; of one "
        "kernel over unordered surfaces for shading; of the step before it for the ladder). "
        "The choice costs above one, and gains below.") + html_table(
            ["choice", "where", "time ratio", "verdict", "table"],
            [effect.cells for effect in found],
            caption="Each choice against its lack; each table's caption says its commit")


CAUSES = (("What does each choice give?", each_idea), ("Which block size?", which_block))
OTHERS = (("Where does the time of a whole process go?", whole_processes),
          ("What do several devices give?", several_devices))
