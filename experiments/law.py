#!/usr/bin/env python3
"""Law: what decides how long the megakernel takes, by the wavefront's time?

Reads the tables that other experiments left (lib/law.py names them) and measures nothing: the ratio of
both modes as a product of factors, with intervals; how well it fits; how well it predicts scenes that it
was not fitted to, which is the test; and where it does not know. `drain`, `shadow` and `sorted` are the
terms of a cell, `predicted` is by the law of the other families of scenes. `--tables DIR` names a folder
of results, else it is that of the device.
"""
import hashlib
import math
import shlex
import sys
from dataclasses import asdict
from pathlib import Path

from lib import harness, law
from lib.harness import Experiment, HarnessError, Plot
from lib.kernels import multiprocessors_of
from lib.provenance import device_folder
from lib.sentences import listed, show

KEPT = ("device", "gpus", "host", "program")  # of the tables' provenance
WORST = 4


def add_arguments(parser):
    parser.add_argument("--tables", metavar="DIR", type=Path, default=None,
                        help="the folder with the tables, where the law is written as well "
                             "[DIR/DEVICE of --output]")


def folder_of(arguments):
    if arguments.tables:
        return arguments.tables
    _program, device = harness.program_and_device(arguments)
    harness.check_gpu(EXPERIMENT, device)
    return arguments.output / device_folder(device)


def read_tables(folder, label):
    """{name: (path, facts)} of those that are there."""
    paths = {name: folder / f"{name}{label and f'-{label}'}.csv" for name in law.TABLES}
    found = {name: (path, harness.read_facts(path)) for name, path in paths.items() if path.is_file()}
    if not found:
        raise HarnessError(f"{folder} has none of {', '.join(path.name for path in paths.values())}: "
                           "measure them first")
    return found


def commit_of(facts):
    return next((line.split()[1] for line in facts["program"] if line.startswith("commit ")), "")


def multiprocessors(facts):
    found = multiprocessors_of(facts["device"]["detail"])
    if not found:
        raise HarnessError(f"device {facts['device']['name']} ({facts['device']['detail']}): expected a GPU")
    return found


def row_of(cell, unseen, whole):
    row = {"experiment": EXPERIMENT.name, "name": cell.name, "status": "measured", "panel": "",
           "series": cell.family, "x": "", "table": cell.table, "measured": f"{cell.ratio:.4f}",
           **{term.name: "" for term in law.TERMS[1:]}, "fitted": "", "predicted_median": "",
           "predicted_low": "", "predicted_high": "", "error": "",
           "verdict": f"unknown: {cell.other}" if cell.other else ""}
    if not cell.other:
        row.update({term.name: f"{cell.terms[term.name]:.4f}" for term in law.TERMS[1:]},
                   fitted=f"{law.predicted(whole, cell):.4f}")
    if unseen:
        row.update(x=f"{cell.ratio:.4f}", predicted_median=f"{unseen.ratio:.4f}",
                   predicted_low=f"{unseen.ratio / unseen.width:.4f}",
                   predicted_high=f"{unseen.ratio * unseen.width:.4f}", error=f"{unseen.error:.4f}",
                   verdict=unseen.verdict)
    return row


def how_near(what, errors):
    near, count, spread = law.hits(errors)
    return f"{what}: {near} of {count} cells within {law.NEAR:.0%}, root mean square {spread:.1%}"


def formula(whole, ends):
    factors = [f"{show(math.exp(whole[name]))} [{show(math.exp(ends[name][0]))}, {show(math.exp(ends[name][1]))}]"
               + ("" if name == "constant" else f"^{name}") for name in whole]
    return f"megakernel / wavefront = {' x '.join(factors)}."


def where_it_turns(whole, cells):
    """For large images: where the ratio passes 1."""
    start, lines = whole.get("constant", 0.0), []
    shadow = whole.get("shadow", 0.0)
    most = max(cell.terms["shadow"] for cell in cells)
    place = -start / shadow if shadow else math.inf
    lines.append(f"Large images, surfaces not sorted: the ratio is {show(math.exp(start))} without shadow rays and "
                 f"{show(math.exp(start + most * shadow))} with the most, {most:.0%}; "
                 + (f"it passes 1 at {place:.0%}." if 0 < place <= most else "it does not pass 1."))
    if "sorted" in whole:
        mine = sorted(cell.terms["shadow"] for cell in cells if cell.terms["sorted"])
        middle = mine[len(mine) // 2]
        rays = math.exp(-(start + middle * shadow) / whole["sorted"])
        lines.append(f"Where surfaces are sorted, with {middle:.0%} shadow rays, it passes 1 at {show(rays)} rays "
                     "per path: " + ("deeper paths want the megakernel." if whole["sorted"] < 0
                                     else "deeper paths want the wavefront."))
    if "drain" in whole:
        lines.append("An image of no more paths than the blocks have in flight multiplies it by "
                     f"{show(math.exp(whole['drain']))}.")
    return lines


def about_unknown(unseen, cells):
    groups = {}
    for cell in cells:
        if cell.other:
            groups.setdefault(cell.other, set()).add(cell.family)
    for one in unseen:
        if one.verdict.startswith("unknown"):
            groups.setdefault(one.verdict.partition(": ")[2], set()).add(one.cell.family)
    if not groups:
        return "It knows all cells."
    return "It does not know: " + "; ".join(f"{why} ({', '.join(sorted(names))})"
                                            for why, names in sorted(groups.items())) + "."


def conclude(cells, whole, ends, unseen):
    inside = [cell for cell in cells if not cell.other]
    fitted = [law.predicted(whole, cell) / cell.ratio - 1 for cell in inside]
    judged = [one for one in unseen if not one.outside]
    near, count, _ = law.hits(one.error for one in judged)
    said = [one for one in judged if not one.verdict.startswith("unknown")]
    right = sum((one.ratio > 1) == (one.cell.ratio > 1) for one in said)
    files = law.on_files(inside)
    worst = sorted(judged, key=lambda one: -abs(one.error))[:WORST]
    return [
        formula(whole, ends),
        *(f"{term.name}: {term.meaning}." for term in law.TERMS if term.name in whole),
        *where_it_turns(whole, inside),
        how_near("Fit", fitted) + f" ({len({cell.family for cell in inside})} families of scenes).",
        how_near("Families that the fit has not seen, one after another, inside of its range",
                 (one.error for one in judged)) + f"; {len(unseen) - len(judged)} cells are outside.",
        *([how_near("Scene files by the law of the built-in scenes", (one.error for one in files)) + "."]
          if files else []),
        f"The goal of {law.GOAL:.0%} within {law.NEAR:.0%} for unseen scenes is "
        + ("reached" if near >= law.GOAL * count else f"missed: {near / max(count, 1):.0%}") + ". The worst: "
        + listed(f"{one.cell.name} (measured {show(one.cell.ratio)}, predicted {show(one.ratio)})"
                 for one in worst) + ".",
        f"It names the faster mode in {len(said)} of {len(unseen)} unseen cells, and is right in {right}.",
        about_unknown(unseen, cells)]


def origin(arguments, tables, whole, ends, conclusions):
    """The provenance: of the program that the tables name, for nothing is measured."""
    first = next(iter(tables.values()))[1]
    commits = sorted({commit_of(facts) for _, facts in tables.values()})
    if len(commits) > 1:
        conclusions = [*conclusions, f"The tables are of {len(commits)} commits: {', '.join(commits)}."]
    return {"experiment": EXPERIMENT.name, "question": EXPERIMENT.question,
            "command": shlex.join(["python3", *sys.argv]), "date": max(facts["date"] for _, facts in tables.values()),
            "quick": any(facts.get("quick") for _, facts in tables.values()) or arguments.quick,
            **{key: first[key] for key in KEPT},
            "tables": {name: {"commit": commit_of(facts), "date": facts["date"],
                              "sha256": hashlib.sha256(path.read_bytes()).hexdigest()[:16]}
                       for name, (path, facts) in tables.items()},
            "law": {name: {"factor": math.exp(whole[name]), "low": math.exp(ends[name][0]),
                           "high": math.exp(ends[name][1])} for name in whole},
            "complete": all(facts.get("complete") is True for _, facts in tables.values()),
            "plot": asdict(EXPERIMENT.plot), "conclusions": conclusions}


def run(experiment, arguments):
    if arguments.list:
        print(", ".join(law.TABLES))
        return 0
    folder = folder_of(arguments)
    tables = read_tables(folder, arguments.label)
    first = next(iter(tables.values()))[1]
    cells = law.cells_of({name: harness.read_rows(path) for name, (path, _) in tables.items()},
                         multiprocessors(first))
    inside = [cell for cell in cells if not cell.other]
    whole = law.fit(inside) if len({cell.family for cell in inside}) > 2 else None
    if not whole or len(inside) < 3 * len(law.TERMS):
        raise HarnessError(f"{len(inside)} cells of {len({cell.family for cell in inside})} families of scenes in "
                           f"{', '.join(tables)} do not tell {len(law.TERMS)} terms")
    ends, unseen = law.intervals(inside), law.leave_one_out(inside)
    by_name = {one.cell.name: one for one in unseen}
    conclusions = conclude(cells, whole, ends, unseen)
    path = folder / f"{experiment.name}{arguments.label and f'-{arguments.label}'}.csv"
    harness.write_table(path, [row_of(cell, by_name.get(cell.name), whole) for cell in cells],
                        origin(arguments, tables, whole, ends, conclusions))
    print("\n".join([*conclusions, f"table: {path}", harness.draw(path)]))
    return 0


EXPERIMENT = Experiment(
    "law", __doc__.splitlines()[0], None,
    Plot("points", "Megakernel / wavefront, predicted by the law of other scenes", "measured", "predicted",
         y="predicted", mark=1.0), add_arguments=add_arguments, needs_gpu=True)

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT, runner=run))
