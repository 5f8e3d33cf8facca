#!/usr/bin/env python3
"""Sizes: which mode is faster for an image of this size, with so many samples and rays per path?

A grid of scenes, image sizes, samples and depths, each rendered by both modes and by the default,
which chooses one of them (--mode auto). `ratio` is the megakernel's time divided by the row's.
`loss` says by how much of the better mode's time a row is slower than it. Other scenes than those
that the rule of --mode auto was fitted on judge it: --scenes FILE...
"""
import shlex
import sys
from statistics import mean

from lib import harness
from lib.harness import Configuration, Experiment, Plot
from lib.ratios import ratio_labels, set_ratios
from lib.scene_files import add_scene_files, scene_files, short_name

SCENES = ["spheres", "rtow", "cornell", "boxes", "statue:100K", "dial:16:0:closed", "instances:1K",
          "fog"]
SIZES = [128, 256, 512, 1024, 2048]
SAMPLES = [1, 4, 16, 64]
DEPTHS = [4, 16, 50]
PATHS_MAX = 1 << 26
BASE = "megakernel"
MODES = [BASE, "wavefront", "auto"]


def add_arguments(parser):
    parser.set_defaults(repeat=5, rounds=1, warmup=1)
    parser.add_argument("--built-in", nargs="*", metavar="SCENE", default=SCENES,
                        help="built-in scenes [those of the rule]")
    add_scene_files(parser)
    parser.add_argument("--modes", nargs="+", choices=MODES, default=MODES, help="[all]")
    parser.add_argument("--sms", metavar="N", type=int, default=0,
                        help="multiprocessors of the GPU to render on, 0: all [%(default)s]")
    for name, values in (("sizes", SIZES), ("samples", SAMPLES), ("depths", DEPTHS)):
        parser.add_argument(f"--{name}", nargs="+", metavar="N", type=int, default=values,
                            help=f"{name} of the grid {values}")


def cells(arguments):
    """(scene, size, samples, depth)"""
    if arguments.quick:
        return [(scene, 16, 2, 4) for scene in ("spheres", "boxes")]
    scenes = [*arguments.built_in, *map(shlex.quote, scene_files(arguments))]
    return [(scene, size, samples, depth) for scene in scenes for depth in arguments.depths
            for size in arguments.sizes for samples in arguments.samples
            if size * size * samples <= PATHS_MAX]


def configurations(arguments, _device):
    part = f" --sms {arguments.sms}" if arguments.sms else ""
    return [Configuration(
        f"{short_name(scene)}, {size}x{size}x{samples}, depth {depth}: {mode}",
        f"--scene {scene} --width {size} --height {size} --spp {samples} --max-depth {depth} "
        f"--mode {mode}{part}",
        {"panel": short_name(scene), "series": f"{samples} samples, depth {depth}",
         "x": size if mode == "wavefront" else "", "variant": mode, "loss": "", **ratio_labels()})
            for scene, size, samples, depth in cells(arguments) for mode in arguments.modes]


def cell_of(row):
    return row["panel"], row["width"], row["spp"], row["max_depth"]


def grouped(rows):
    groups = {}
    for row in rows:
        groups.setdefault(cell_of(row), {})[row["variant"]] = row
    return groups


def finish(rows, _arguments):
    set_ratios(rows, BASE, cell_of)
    for cell in grouped(rows).values():
        times = {mode: float(row["kernel_ms_median"]) for mode, row in cell.items()}
        best = min(times.get(mode, float("inf")) for mode in ("megakernel", "wavefront"))
        for mode, row in cell.items():
            row["loss"] = f"{times[mode] / best - 1:.4f}"


def conclude(rows, _arguments):
    """How often each mode wins, and what --mode auto loses."""
    lines = []
    compared = [cell for cell in grouped(rows).values() if {"megakernel", "wavefront"} <= set(cell)]
    for mode in MODES:
        losses = sorted((float(cell[mode]["loss"]), cell[mode]["name"])
                        for cell in compared if mode in cell)
        if not losses:
            continue
        within = [sum(loss <= most for loss, _ in losses) for most in (0.05, 0.15)]
        lines.append(f"{mode}: on average {mean(loss for loss, _ in losses):.1%} slower than the "
                     f"better mode, at worst {losses[-1][0]:.1%} ({losses[-1][1]}); within 5 % in "
                     f"{within[0]} and within 15 % in {within[1]} of {len(losses)} cells")
    return lines


EXPERIMENT = Experiment(
    "sizes", __doc__.splitlines()[0], configurations,
    Plot("lines", "Time of the megakernel by that of the wavefront", "width and height [pixels]",
         "megakernel / wavefront", y="ratio", mark=1.0),
    add_arguments=add_arguments, finish=finish, conclude=conclude, table=("ratio_median", "loss"))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
