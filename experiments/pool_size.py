#!/usr/bin/env python3
"""Pool size: how many paths should the wavefront keep in flight, and what is regeneration worth?

With --regenerate off the pool runs empty before it is filled again. A pool for the whole batch is
the default; there nothing is to be regenerated.
"""
import sys

from lib import harness
from lib.harness import Configuration, Experiment, Plot
from lib.images import images_of
from lib.scene_files import add_scene_files
from lib.sentences import against, best_of, in_groups

SIZES = {"64K": 1 << 16, "256K": 1 << 18, "1M": 1 << 20, "4M": 1 << 22, "8M": 1 << 23}
QUICK_SIZES = {"64": 64, "256": 256}
KEPT, EMPTIED = "regenerated", "filled when empty"
SERIES = {KEPT: "on", EMPTIED: "off"}


def configurations(arguments, _device):
    sizes = QUICK_SIZES if arguments.quick else SIZES
    return [Configuration(
        f"{scene}: pool of {size}, {series}",
        f"--mode wavefront {image} --pool-size {size} --regenerate {choice}",
        {"panel": scene, "series": series, "x": paths, "pool": size}, same_image=scene)
            for scene, image in images_of(arguments).items()
            for size, paths in sizes.items() for series, choice in SERIES.items()]


def conclude(rows, _arguments):
    lines = []
    for scene, mine in in_groups(rows, "panel").items():
        kept = [row for row in mine if row["series"] == KEPT]
        if kept:
            lines.append(f"{scene}, regenerated: fastest with a pool of {best_of(kept, 'pool')}; "
                         "memory: " + ", ".join(
                             f"{int(row['memory_bytes']) / 2**20:,.0f} MiB ({row['pool']})"
                             for row in kept))
        for pool, pair in in_groups(mine, "pool").items():
            by_series = {row["series"]: row for row in pair}
            if len(by_series) == 2:
                lines.append(f"{scene}, pool of {pool}, regenerated: "
                             f"{against(by_series[EMPTIED], by_series[KEPT], EMPTIED)}")
    return lines


EXPERIMENT = Experiment(
    "pool_size", __doc__.splitlines()[0], configurations,
    Plot("lines", "Pool size of the wavefront, with and without regeneration", "paths in flight"),
    add_arguments=add_scene_files, conclude=conclude)

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
