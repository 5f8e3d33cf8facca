#!/usr/bin/env python3
"""Toggles: what does each of the paper's choices cost or gain, alone?

Every row differs from the defaults of its mode by one option; the wavefront's stages are split, as
the paper's toggles ask, in all rows but one. All but --rng xorwow give the same image. (`pool_size`
has the sizes of the pool and regeneration.)
"""
import sys

from lib import harness
from lib.harness import Configuration, Experiment, Plot
from lib.image_check import with_options
from lib.sentences import against, in_groups

BOTH = [("scene-memory", ["global", "shared", "constant"]), ("branching", ["reduced"]),
        ("rng", ["xorwow"])]
TOGGLES = {
    "megakernel": [*BOTH, ("work", ["pixel", "sample"])],
    "wavefront": [*BOTH, ("compaction", ["cub", "none"]), ("schedule", ["host"]),
                  ("layout", ["soa", "aos"]), ("finish-paths", ["0"]), ("stages", ["fused"])],
}
BASE = {"megakernel": "", "wavefront": "--stages split"}


def changes_of(mode):
    """{name: options} of a mode's rows."""
    changes = {f"{option} {value}": f"--{option} {value}"
               for option, values in TOGGLES[mode] for value in values}
    return {name: " ".join(with_options(BASE[mode], change))
            for name, change in {"default": "", **changes}.items()}


def configurations(arguments, _device):
    image = "--width 600 --height 300 --spp 50 --max-depth 50"
    if arguments.quick:
        image = "--width 60 --height 30 --spp 5 --max-depth 50"
    return [Configuration(f"{mode}: {name}", f"--mode {mode} {image} {options}",
                          {"panel": mode, "x": name, "relative_to_default": ""},
                          same_image="" if name == "rng xorwow" else "spheres")
            for mode in TOGGLES for name, options in changes_of(mode).items()]


def finish(rows, _arguments):
    defaults = {row["panel"]: float(row["kernel_ms_median"]) for row in rows
                if row["x"] == "default"}
    for row in rows:
        if row["panel"] in defaults:
            relative = float(row["kernel_ms_median"]) / defaults[row["panel"]]
            row["relative_to_default"] = f"{relative:.3f}"


def conclude(rows, _arguments):
    lines = []
    for mode, mine in in_groups(rows, "panel").items():
        default = next((row for row in mine if row["x"] == "default"), None)
        lines += [f"{mode}, {row['x']}: {against(default, row, 'the default')}"
                  for row in mine if default and row is not default]
    return lines


EXPERIMENT = Experiment(
    "toggles", __doc__.splitlines()[0], configurations,
    Plot("bars", "The paper's toggles, each alone: spheres, 600x300, 50 samples, depth 50",
         log_y=False),
    finish=finish, conclude=conclude, table=("relative_to_default",))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
