#!/usr/bin/env python3
"""Scene memory: where should the spheres lie as they grow in number: global, constant, shared?

Every sphere is tested (--accel brute) or a tree is asked (bvh2), whose nodes and spheres are in global
memory always. What does not fit into constant or shared memory is refused. A CPU has one memory only: there the
rows of the others are refused.
"""
import sys

from lib import harness
from lib.harness import Configuration, Experiment, Plot
from lib.kernels import set_occupancy
from lib.sentences import against, best_of, in_groups, listed

MEMORIES = ["global", "constant", "shared"]
# (mode, structure, numbers of spheres); ptexp's kernels take 1,024 as a constant, and a block of an
# H200 has shared memory for some 14,000
SERIES = [("megakernel", "brute", [50, 250, 1000, 4000]),
          ("megakernel", "bvh2", [50, 1000, 12000]),
          ("wavefront", "brute", [50, 250, 1000])]
IMAGE = "--width 600 --height 300 --spp 50 --max-depth 50"
QUICK_IMAGE = "--width 24 --height 12 --spp 2 --max-depth 50"


def configurations(arguments, _device):
    image = QUICK_IMAGE if arguments.quick else IMAGE
    return [Configuration(
        f"{mode}, {accel}, {count} spheres: {memory}",
        f"--mode {mode} --accel {accel} --spheres {count} --scene-memory {memory} {image}",
        {"panel": f"{mode}, {accel}", "series": memory, "x": count, "occupancy": ""},
        same_image=f"{count} spheres, {accel}")
            for mode, accel, counts in SERIES for count in counts
            for memory in (MEMORIES if accel == "brute" else MEMORIES[:1])]


def finish(rows, _arguments):
    for row in rows:
        set_occupancy(row)


def conclude(rows, _arguments):
    lines = []
    for (panel, count), mine in in_groups(rows, "panel", "x").items():
        by_memory = {row["series"]: row for row in mine}
        if all(row["device_kind"] == "cpu" for row in mine):
            lines.append(f"{panel}, {count} spheres: measured in {listed(by_memory)} memory alone; "
                         "the others need a GPU")
            continue
        others = [f"{memory}: {against(by_memory['global'], row, 'global')}"
                  for memory, row in by_memory.items() if memory != "global"
                  and "global" in by_memory]
        lines.append(f"{panel}, {count} spheres: fastest in {best_of(mine, 'series')} memory; "
                     + ("; ".join(others) or "nothing else fits"))
    return lines


EXPERIMENT = Experiment(
    "scene_memory", __doc__.splitlines()[0], configurations,
    Plot("lines", "Scene memory: spheres, 600x300, 50 samples, depth 50", "spheres"),
    finish=finish, conclude=conclude, table=("occupancy",))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
