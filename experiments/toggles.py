#!/usr/bin/env python3
"""Toggles: what does each of the paper's choices cost or gain, alone?

A row differs from the first one of its panel by one option. That is the default of a mode; but the
paper's toggles of the wavefront apply to split stages, which are the default on CPUs alone, so these
have a panel of their own. All but --rng xorwow give the same image. (`pool_size` has the sizes of
the pool and regeneration.)
"""
import sys

from lib import harness
from lib.harness import Configuration, Experiment, Plot
from lib.image_check import with_options
from lib.sentences import BASES, against, in_groups

BOTH = [("scene-memory", ["global", "shared", "constant"]), ("branching", ["reduced"]),
        ("rng", ["xorwow"])]
# panel: (mode, options of all its rows, what each of the others changes)
PANELS = {
    "megakernel": ("megakernel", "", [*BOTH, ("work", ["pixel", "sample"])]),
    "wavefront": ("wavefront", "", [("stages", ["split", "fused"])]),
    "wavefront, split stages": ("wavefront", "--stages split", [
        *BOTH, ("compaction", ["cub", "none"]), ("schedule", ["host"]), ("layout", ["soa", "aos"]),
        ("finish-paths", ["0"])]),
}


def changes_of(panel):
    """{name: options} of a panel's rows, the one first that the others are compared with."""
    _, base, toggles = PANELS[panel]
    changes = {f"{option} {value}": f"--{option} {value}"
               for option, values in toggles for value in values}
    return {name: " ".join(with_options(base, change))
            for name, change in {BASES[1] if base else BASES[0]: "", **changes}.items()}


def configurations(arguments, _device):
    image = "--width 600 --height 300 --spp 50 --max-depth 50"
    if arguments.quick:
        image = "--width 60 --height 30 --spp 5 --max-depth 50"
    return [Configuration(f"{panel}: {name}", f"--mode {mode} {image} {options}",
                          {"panel": panel, "x": name, "relative_to_first": ""},
                          same_image="" if name == "rng xorwow" else "spheres")
            for panel, (mode, *_) in PANELS.items() for name, options in changes_of(panel).items()]


def finish(rows, _arguments):
    first = {row["panel"]: float(row["kernel_ms_median"]) for row in rows if row["x"] in BASES}
    for row in rows:
        if row["panel"] in first:
            relative = float(row["kernel_ms_median"]) / first[row["panel"]]
            row["relative_to_first"] = f"{relative:.3f}"


def conclude(rows, _arguments):
    lines = []
    for panel, mine in in_groups(rows, "panel").items():
        base = next((row for row in mine if row["x"] in BASES), None)
        lines += [f"{panel}, {row['x']}: "
                  + against(base, row, "the default" if base["x"] == BASES[0] else "split stages alone")
                  for row in mine if base and row is not base]
    return lines


EXPERIMENT = Experiment(
    "toggles", __doc__.splitlines()[0], configurations,
    Plot("bars", "The paper's toggles, each alone: spheres, 600x300, 50 samples, depth 50",
         log_y=False),
    finish=finish, conclude=conclude, table=("relative_to_first",))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
