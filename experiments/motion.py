#!/usr/bin/env python3
"""Motion: what do things that move cost each mode, and does the faster one change?

`instances:N:P` is a forest of which P percent of the N trees sway while the shutter is open: a ray that
meets the box of one has to make its pose at the path's time and invert it. With 0 percent the kernels
know no time. All trace trees of one builder: binary ones, and wide ones where `wide` is in the name,
which on CUDA persistent warps and the megakernel's blocks trace. `ratio` is the megakernel's time divided by the
variant's, `ns_per_ray_*` a row's time divided by its rays and shadow rays, and `motion_cost` that divided
by the same variant's where all stands still. First, images of all variants are compared: they must be
equal bit for bit.
"""
import sys

from lib import harness
from lib.harness import Configuration, Experiment, Plot
from lib.options import add_image_options
from lib.ratios import ns_per_ray, ratio_labels, set_ratios

PERCENTS, QUICK_PERCENTS = [0, 1, 10, 100], [0, 50]
TREES, QUICK_TREES = ["1K", "10K", "100K"], ["20"]
PARTS = ["median", "min", "max"]
BASE = "megakernel"
VARIANTS = {
    BASE: "--mode megakernel --accel bvh2",
    "wavefront": "--mode wavefront --stages split --accel bvh2",
    "fused": "--mode wavefront --stages fused --accel bvh2",
    "megakernel, wide": "--mode megakernel --accel cwbvh",
    "wavefront, wide": "--mode wavefront --stages split --accel cwbvh",
    "fused, wide": "--mode wavefront --stages fused --accel cwbvh",
}


def add_arguments(parser):
    parser.set_defaults(repeat=6, rounds=2, warmup=1)
    add_image_options(parser)


def configurations(arguments, _device):
    quick = arguments.quick
    size, spp = (24, 2) if quick else (arguments.size, arguments.spp)
    return [Configuration(
        f"{trees} trees, {percent} %: {variant}",
        f"--scene instances:{trees}:{percent} --width {size} --height {size} --spp {spp} --max-depth 8 "
        f"--builder sah {options}",
        {"panel": f"{trees} trees", "series": variant, "x": f"{percent} %: {variant}", "trees": trees,
         "percent": percent, "variant": variant, **{f"ns_per_ray_{part}": "" for part in PARTS},
         "motion_cost": "", **ratio_labels()},
        same_image=f"{trees}:{percent}")
        for trees in (QUICK_TREES if quick else TREES)
        for percent in (QUICK_PERCENTS if quick else PERCENTS) for variant, options in VARIANTS.items()]


def scene_of(row):
    return row["trees"], row["percent"]


def finish(rows, _arguments):
    set_ratios(rows, BASE, scene_of)
    measured = [row for row in rows if row["kernel_ms_median"]]
    for row in measured:
        for part in PARTS:
            row[f"ns_per_ray_{part}"] = ns_per_ray(row, part)
    still = {(row["trees"], row["variant"]): float(row["ns_per_ray_median"]) for row in measured
             if int(row["percent"]) == 0}
    for row in measured:
        if base := still.get((row["trees"], row["variant"])):
            row["motion_cost"] = f"{float(row['ns_per_ray_median']) / base:.4g}"


def conclude(rows, _arguments):
    """A sentence for each scene: the fastest variant, how far the others are, what motion costs it."""
    scenes = {}
    for row in rows:
        if row["motion_cost"]:
            scenes.setdefault(scene_of(row), []).append(row)
    sentences = []
    for (trees, percent), variants in scenes.items():
        best, *others = sorted(variants, key=lambda row: -float(row["ratio_median"]))
        slower = ", ".join(f"{row['variant']} takes {float(best['ratio_median']) / float(row['ratio_median']):.2f}"
                           for row in others)
        sentences.append(
            f"{trees} trees, {percent} % of which sway: {best['variant']} is fastest"
            + (f" ({slower} times as long)" if others else "")
            + f"; its ray takes {float(best['motion_cost']):.2f} times as long as where all stand still")
    return sentences


EXPERIMENT = Experiment(
    "motion", __doc__.splitlines()[0], configurations,
    Plot("bars", "A forest that sways: time of a ray", "", "ns per ray", y="ns_per_ray",
         log_y=False),
    add_arguments=add_arguments, finish=finish, conclude=conclude,
    table=("ratio_median", "ns_per_ray_median", "motion_cost"))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
