#!/usr/bin/env python3
"""Block size: how many threads should a thread block have?

The paper's second measurement: blocks of 4x4 to 32x32 threads, and 64x64, which no GPU runs. The
wavefront's kernels, one for each stage, have one-dimensional blocks of as many threads. `idle` is the share of threads
without a pixel, where each has one; `lanes` the share of a warp's lanes that have a thread: a block
of 4x4 leaves half of its warp empty. Needs a GPU.
"""
import sys

from lib import harness
from lib.harness import Configuration, Experiment, Plot
from lib.kernels import set_occupancy
from lib.sentences import against, best_of, in_groups, show

IMAGES = [(600, 300, 50), (2400, 1200, 50)]
EDGES = [4, 8, 16, 32, 64]
STAGE_BLOCKS = [16, 32, 64, 256, 1024]
WARP = 32

# (series, threads per block, options)
BLOCKS = [(f"megakernel, {work}", edge * edge,
           f"--mode megakernel --work {work} --block {edge}x{edge}")
          for work in ("pixel", "persistent") for edge in EDGES]
BLOCKS += [("wavefront", threads, f"--mode wavefront --stages split --stage-block {threads}")
           for threads in STAGE_BLOCKS]


def configurations(arguments, _device):
    result = []
    for width, height, spp in IMAGES:
        if arguments.quick:
            width, height, spp = width // 10, height // 10, spp // 10
        panel = f"{width}x{height}, {spp} samples"
        image = f"--width {width} --height {height} --spp {spp} --max-depth 50"
        result += [Configuration(f"{series}, {threads} threads, {panel}", f"{options} {image}",
                                 {"series": series, "panel": panel, "x": threads, "idle": "",
                                  "lanes": "", "occupancy": ""},
                                 same_image="spheres")
                   for series, threads, options in BLOCKS]
    return result


def idle_share(row):
    """Threads of a launch with one thread a pixel that have no pixel."""
    width, height = int(row["width"]), int(row["height"])
    across, down = (int(side) for side in row["block"].split("x"))
    threads = -(-width // across) * across * -(-height // down) * down
    return 1 - width * height / threads


def finish(rows, _arguments):
    for row in rows:
        threads = int(row["x"])
        row["lanes"] = f"{threads / (-(-threads // WARP) * WARP):.4g}"
        if row["mode"] == "megakernel" and row["work"] == "pixel":
            row["idle"] = f"{idle_share(row):.4f}"
        set_occupancy(row)


def conclude(rows, _arguments):
    """What is best, what half-empty warps cost, and how many threads have nothing to do."""
    lines = []
    for (panel, series), mine in in_groups(rows, "panel", "series").items():
        lines.append(f"{panel}, {series}: fastest with blocks of {best_of(mine, 'x')} threads")
        full = [row for row in mine if row["lanes"] == "1"]
        for row in mine:
            if full and row["lanes"] != "1":
                lines.append(f"{panel}, {series}: {row['x']} threads, {show(float(row['lanes']))} "
                             f"of a warp: {against(full[0], row, full[0]['x'])}")
        idle = [f"{float(row['idle']):.1%} with {row['block']}" for row in mine if row["idle"]]
        if idle:
            lines.append(f"{panel}, {series}: threads without a pixel: {', '.join(idle)}")
    return lines


EXPERIMENT = Experiment(
    "block_size", __doc__.splitlines()[0], configurations,
    Plot("lines", "Block size: spheres, depth 50", "threads per block"),
    finish=finish, conclude=conclude, table=("idle", "lanes", "occupancy"), needs_gpu=True)

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
