#!/usr/bin/env python3
"""Media: which mode is faster in a medium, and where should null collisions be sampled?

The scene `cloud:N:T:A` is a grid of N^3 voxels with optical depth T and albedo A, `fog` a homogeneous
medium in a room (docs/scenes.md). Each of density, albedo and grid size varies alone. The megakernel
loops over a flight's null collisions in its lane; so does the wavefront, or it lets a path wait for
the next wave after some of them (--wave-collisions). `ratio` is the megakernel's time divided by the
variant's. All trace the same structure. First, images of all variants are compared: they must be equal
bit for bit.

`cloud:N:T:A:sparse:P` fills P percent of N^3 voxels. Its side and its share vary, each time as a sparse
grid and as a dense copy (--volume); `sparse_gain` is the copy's time divided by the sparse grid's, and
`ns_per_ray` a row's time divided by its rays and shadow rays, each of which has at most one flight in
the grid. `ptexp --counters` tells the lanes and bytes of a row's kernels.
"""
import sys

from lib import harness
from lib.harness import Configuration, Experiment, Plot
from lib.options import add_image_options
from lib.ratios import ns_per_ray, ratio_labels, set_ratios

DEPTHS = [0.1, 0.3, 1, 3, 10, 30, 100]
ALBEDOS = [0, 0.5, 0.9, 0.99, 0.999]
SIDES = [16, 64, 256, 512]
SPARSE_SIDES, DENSE_SIDE_MOST = [256, 512, 1024, 2048], 1024
SHARES, SHARES_SIDE = [1, 2, 5, 10, 20, 40], 512
STORAGES = ["sparse", "dense"]
SIDE, DEPTH, ALBEDO = 128, 10, 0.999
BASE = "megakernel"
VARIANTS = {
    BASE: "--mode megakernel",
    "loop": "--mode wavefront",
    "waves of 1": "--mode wavefront --wave-collisions 1",
    "waves of 4": "--mode wavefront --wave-collisions 4",
    "waves of 16": "--mode wavefront --wave-collisions 16",
    "fused": "--mode wavefront --stages fused",
}


def add_arguments(parser):
    parser.set_defaults(repeat=6, rounds=2, warmup=1)
    add_image_options(parser)
    parser.add_argument("--max-depth", type=int, default=128, metavar="N",
                        help="rays of a path; roulette begins after 16 [%(default)s]")


def sparse_scenes(sides, shares, shares_side):
    def scene(side, share, storage):
        return f"cloud:{side}:{DEPTH}:{ALBEDO}:sparse:{share:g} --volume {storage}"
    return ([(f"side, {storage}", n, scene(n, 2, storage)) for storage in STORAGES for n in sides
             if storage == "sparse" or n <= DENSE_SIDE_MOST]
            + [(f"percent, {storage}", p, scene(shares_side, p, storage)) for storage in STORAGES
               for p in shares])


def scenes_of(quick):
    """(figure, x, scene): what varies, its value, and where."""
    if quick:
        return [("optical depth", 3, f"cloud:16:3:{ALBEDO}"), ("homogeneous", 0, "fog"),
                *sparse_scenes([64], [10], 64)]
    return ([("optical depth", t, f"cloud:{SIDE}:{t}:{ALBEDO}") for t in DEPTHS]
            + [("albedo", a, f"cloud:{SIDE}:{DEPTH}:{a}") for a in ALBEDOS]
            + [("voxels along a side", n, f"cloud:{n}:{DEPTH}:{ALBEDO}") for n in SIDES]
            + sparse_scenes(SPARSE_SIDES, SHARES, SHARES_SIDE) + [("homogeneous", 0, "fog")])


def configurations(arguments, _device):
    size, spp = (24, 2) if arguments.quick else (arguments.size, arguments.spp)
    rows = []
    for figure, x, scene in scenes_of(arguments.quick):
        for variant, options in VARIANTS.items():
            if figure == "homogeneous" and "collisions" in options:
                continue  # it has no null collisions
            drawn = variant != BASE and figure != "homogeneous"
            rows.append(Configuration(
                f"{figure} {x:g}: {variant}",
                f"--scene {scene} --width {size} --height {size} --spp {spp} "
                f"--max-depth {arguments.max_depth} --rr 16 --accel bvh2 {options}",
                {"panel": figure, "series": variant, "x": x if drawn else "", "figure": figure,
                 "value": x, "variant": variant, "sparse_gain": "", "ns_per_ray": "",
                 **ratio_labels()},
                same_image=scene.split(" --volume")[0]))
    return rows


def scene_of(row):
    return row["figure"], row["value"]


def finish(rows, _arguments):
    set_ratios(rows, BASE, scene_of)
    copies = {(row["figure"], row["value"], row["variant"]): row for row in rows}
    for row in rows:
        if not row["kernel_ms_median"]:
            continue
        row["ns_per_ray"] = ns_per_ray(row)
        quantity, _, storage = row["figure"].partition(", ")
        copy = copies.get((f"{quantity}, dense", row["value"], row["variant"]))
        if storage == "sparse" and copy and copy["kernel_ms_median"]:
            gain = float(copy["kernel_ms_median"]) / float(row["kernel_ms_median"])
            row["sparse_gain"] = f"{gain:.4f}"


def conclude(rows, _arguments):
    """A sentence for each scene: the best variant."""
    scenes = {}
    for row in rows:
        scenes.setdefault(scene_of(row), []).append(row)
    sentences = []
    for (figure, value), variants in scenes.items():
        measured = [row for row in variants if row["ratio_median"]]
        if not measured:
            continue
        best = max(measured, key=lambda row: float(row["ratio_median"]))
        sentences.append(f"{figure} {value}: {best['variant']} is fastest, "
                         f"{float(best['ratio_median']):.2f} times the megakernel's speed")
    gains = [(row["value"], row["variant"], float(row["sparse_gain"])) for row in rows
             if row["figure"] == "percent, sparse" and row["sparse_gain"]]
    for variant in dict.fromkeys(variant for _, variant, _ in gains):
        slower = [share for share, of, gain in gains if of == variant and gain < 1]
        sentences.append(f"{variant}: the dense copy is faster " + (
            f"from {min(slower):g} % on" if slower else "at no share"))
    return sentences


EXPERIMENT = Experiment(
    "media", __doc__.splitlines()[0], configurations,
    Plot("lines", "A cloud: time of the megakernel by that of the wavefront",
         "", "megakernel / wavefront", y="ratio", mark=1.0),
    add_arguments=add_arguments, finish=finish, conclude=conclude, table=("ratio_median", "sparse_gain", "ns_per_ray"))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
