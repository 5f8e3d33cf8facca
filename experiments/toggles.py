#!/usr/bin/env python3
"""Toggles: what does each of the paper's choices cost or gain, alone?

Every row differs from the defaults of its mode by one option (and by --regenerate off at each pool
size). All but --rng xorwow give the same image.
"""
import sys

import harness
from harness import Configuration, Experiment, Plot

BOTH = [("scene-memory", ["global", "shared", "constant"]), ("branching", ["reduced"]),
        ("rng", ["xorwow"])]
TOGGLES = {
    "megakernel": [*BOTH, ("work", ["pixel", "sample"])],
    "wavefront": [*BOTH, ("compaction", ["cub", "none"]), ("schedule", ["host"]),
                  ("layout", ["aos"]), ("finish-paths", ["0"])],
}
POOL_SIZES = ["128K", "256K", "512K", "1M", "2M", "4M", "8M"]
QUICK_POOL_SIZES = ["1K", "4K"]


def changes_of(mode, pool_sizes):
    """{name: options} of a mode's rows. Regeneration matters in a pool below the whole batch."""
    changes = {"default": ""}
    for option, values in TOGGLES[mode]:
        changes.update({f"{option} {value}": f"--{option} {value}" for value in values})
    if mode == "wavefront":
        for size in pool_sizes:
            changes[f"pool-size {size}"] = f"--pool-size {size}"
            changes[f"pool-size {size}, regenerate off"] = f"--pool-size {size} --regenerate off"
    return changes


def configurations(arguments, _device):
    image = "--width 600 --height 300 --spp 50 --max-depth 50"
    pool_sizes = POOL_SIZES
    if arguments.quick:
        image, pool_sizes = "--width 60 --height 30 --spp 5 --max-depth 50", QUICK_POOL_SIZES
    return [Configuration(f"{mode}: {name}", f"--mode {mode} {image} {options}",
                          {"panel": mode, "x": name, "relative_to_default": ""},
                          same_image="" if name == "rng xorwow" else "spheres")
            for mode in TOGGLES for name, options in changes_of(mode, pool_sizes).items()]


def finish(rows, _arguments):
    defaults = {row["panel"]: float(row["kernel_ms_median"]) for row in rows
                if row["x"] == "default"}
    for row in rows:
        if row["panel"] in defaults:
            relative = float(row["kernel_ms_median"]) / defaults[row["panel"]]
            row["relative_to_default"] = f"{relative:.3f}"


EXPERIMENT = Experiment(
    "toggles", __doc__.splitlines()[0], configurations,
    Plot("bars", "The paper's toggles, each alone: spheres, 600x300, 50 samples, depth 50",
         log_y=False),
    finish=finish, table=("relative_to_default",))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
