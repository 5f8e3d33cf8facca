#!/usr/bin/env python3
"""Dial: from how many materials on is the wavefront faster than the megakernel?

The scene `dial:K:C:F` has K materials with coherence C (0 noise, 1 stripes), open or closed
(docs/scenes.md). Each variant of the wavefront (one kernel for all materials, the same over a queue
ordered by kind, a kernel for each kind) is compared with the megakernel, which keeps its
default work and block; `ratio` is the megakernel's time divided by the variant's, so the crossover
is where it passes 1. All trace the same structure (--accel), so that shading makes the difference,
but for three that exist on CUDA alone, with wide trees: the megakernel whose warps vote, the one
whose blocks sort, and the wavefront with its persistent warps, which are both sides at their best.
First, images of all variants are compared: they must be equal bit for bit.
"""
import math
import sys

from lib import harness
from lib.harness import Configuration, Experiment, Plot
from lib.image_check import with_options
from lib.options import add_image_options
from lib.ratios import ratio_labels, set_ratios

FIGURES = ["open", "closed"]
MATERIALS = [1, 2, 4, 8, 16, 32]
COHERENCES = [0, 0.5, 1]
BASE = "megakernel"
VARIANTS = {
    BASE: "--mode megakernel",
    "voting megakernel": "--mode megakernel --accel cwbvh --kernel vote",
    "sorting megakernel": "--mode megakernel --accel cwbvh --kernel sort",
    "uber": "--mode wavefront --stages split --order-surfaces off",
    "uber, sorted": "--mode wavefront --stages split --order-surfaces on",
    "wide tree": "--mode wavefront --accel cwbvh",
}
DEPTH = 8


def add_arguments(parser):
    parser.set_defaults(repeat=6, rounds=2, warmup=1)  # 256 processes: some minutes on a GPU
    parser.add_argument("--materials", type=int, nargs="+", default=MATERIALS, metavar="K",
                        help="numbers of materials, 1 to 32 [%(default)s]")
    parser.add_argument("--coherences", type=float, nargs="+", default=COHERENCES, metavar="C",
                        help="0 noise, 1 stripes [%(default)s]")
    add_image_options(parser)
    parser.add_argument("--accel", default="bvh2", metavar="NAME",
                        help="the structure that all variants trace [%(default)s]")


def image_of(scene, size, spp, arguments):
    return (f"--scene {scene} --width {size} --height {size} --spp {spp} --max-depth {DEPTH} "
            f"--accel {arguments.accel}")


def scenes_of(arguments):
    """(figure, materials, coherence) of each scene: one material lies in one way only."""
    materials = [1, 3] if arguments.quick else arguments.materials
    coherences = [0] if arguments.quick else arguments.coherences
    return [(figure, count, f"{coherence:g}") for figure in FIGURES for count in materials
            for coherence in (coherences if count > 1 else coherences[:1])]


def configurations(arguments, device):
    size, spp = (24, 1) if arguments.quick else (arguments.size, arguments.spp)
    rows = []
    for figure, materials, coherence in scenes_of(arguments):
        scene = f"dial:{materials}:{coherence}:{figure}"
        image = image_of(scene, size, spp, arguments)
        for variant, options in VARIANTS.items():
            if "cwbvh" in options and device.kind != "cuda":
                continue
            is_base = variant == BASE  # in no plot: the others are drawn relative to it
            rows.append(Configuration(
                f"{scene}: {variant}", " ".join(with_options(image, options)),
                {"panel": f"{figure}, {variant}", "series": f"coherence {coherence}",
                 "x": "" if is_base else materials, "figure": figure, "materials": materials,
                 "coherence": coherence, "variant": variant,
                 **ratio_labels()}, same_image=scene))
    return rows


def finish(rows, _arguments):
    def scene(row):
        return row["figure"], row["materials"], row["coherence"]
    set_ratios(rows, BASE, scene)


def crossing(points):
    """Where the ratio passes 1 for good, by a line over the logarithm of the materials: a number, 0
    if it is never below 1, infinite if it ends below. `points`: (materials, ratio), ascending."""
    below = [i for i, (_, ratio) in enumerate(points) if ratio < 1]
    if not below:
        return 0
    last = below[-1]
    if last + 1 == len(points):
        return math.inf
    (k0, r0), (k1, r1) = points[last:last + 2]
    return k0 * (k1 / k0) ** ((1 - r0) / (r1 - r0))


def describe(points):
    crossover, least, most = crossing(points), points[0][0], points[-1][0]
    end = f"{points[-1][1]:.2f} times as fast with {most}"
    if crossover == 0:
        return f"faster from {least} on, {end}"
    if math.isinf(crossover):
        return f"slower with {most} still: {points[-1][1]:.2f} times as fast"
    return f"crossover at about {crossover:.1f} materials, {end}"


def conclude(rows, _arguments):
    """A sentence for each line of the plot."""
    lines = {}
    for row in rows:
        if row["variant"] != BASE and row["ratio_median"]:
            key = f"{row['figure']}, {row['series']}, {row['variant']}"
            lines.setdefault(key, []).append((int(row["materials"]), float(row["ratio_median"])))
    return [f"{key}: {describe(sorted(points))}" for key, points in lines.items()]


EXPERIMENT = Experiment(
    "dial", __doc__.splitlines()[0], configurations,
    Plot("lines", "The divergence dial: time of the megakernel by that of the wavefront",
         "materials", "megakernel / wavefront", y="ratio", log_y=False, mark=1.0),
    add_arguments=add_arguments, finish=finish, conclude=conclude,
    table=("ratio_median",))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
