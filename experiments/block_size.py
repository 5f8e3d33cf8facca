#!/usr/bin/env python3
"""Block size: how many threads should a thread block have?

The paper's second measurement: blocks of 4x4 to 32x32 threads, and 64x64, which no GPU runs. The
wavefront's kernels have one-dimensional blocks of as many threads. Needs a GPU.
"""
import sys

import harness
from harness import Configuration, Experiment, Plot

IMAGES = [(600, 300, 50), (2400, 1200, 50)]
EDGES = [4, 8, 16, 32, 64]
STAGE_BLOCKS = [16, 64, 256, 1024]


# (series, threads per block, options)
BLOCKS = [(f"megakernel, {work}", edge * edge,
           f"--mode megakernel --work {work} --block {edge}x{edge}")
          for work in ("pixel", "persistent") for edge in EDGES]
BLOCKS += [("wavefront", threads, f"--mode wavefront --stage-block {threads}")
           for threads in STAGE_BLOCKS]


def configurations(arguments, _device):
    result = []
    for width, height, spp in IMAGES:
        if arguments.quick:
            width, height, spp = width // 10, height // 10, spp // 10
        panel = f"{width}x{height}, {spp} samples"
        image = f"--width {width} --height {height} --spp {spp} --max-depth 50"
        result += [Configuration(f"{series}, {threads} threads, {panel}", f"{options} {image}",
                                 {"series": series, "panel": panel, "x": threads},
                                 same_image="spheres")
                   for series, threads, options in BLOCKS]
    return result


EXPERIMENT = Experiment(
    "block_size", __doc__.splitlines()[0], configurations,
    Plot("lines", "Block size: spheres, depth 50", "threads per block"))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
