#!/usr/bin/env python3
"""Hardware: what does OptiX change about the wavefront's rays, and what do equal hits cost there?

The wavefront traces its queues by our persistent warps or by OptiX, all other stages being the same;
the host launches the waves in all rows, and no path is finished outside of them. `mrays_*` is rays
and shadow rays per second of the stages that trace (10^6/s), `ratio_*` our tracer's time of the whole
render divided by the row's. Images of `custom` are compared with ours first; those of `any-hit` and
`built-in` may differ in some pixels. A GPU without RT cores (an H100 or H200 has none) runs OptiX by
software: then a row says nothing of hardware.
"""
import shlex
import sys

from lib import harness
from lib.harness import Configuration, Experiment, Plot
from lib.ratios import ratio_labels, set_ratios
from lib.scene_files import add_scene_files, scene_files, short_name

BASE = "ours"
VARIANTS = {BASE: "--accel cwbvh --schedule host --finish-paths 0",
            "custom": "--accel optix --optix-hits custom",
            "any-hit": "--accel optix --optix-hits any-hit",
            "built-in": "--accel optix --optix-hits built-in"}
SCENES = ["statue:1M", "terrain:1M", "boxes", "instances:100K", "dial:16:0.5:closed"]
QUICK = ["statue:3K", "instances:20"]
PARTS = {"median": "median", "min": "max", "max": "min"}


def add_arguments(parser):
    add_scene_files(parser)
    parser.add_argument("--size", type=int, default=1024, metavar="N",
                        help="width and height in pixels [%(default)s]")
    parser.add_argument("--spp", type=int, default=8, metavar="N",
                        help="samples per pixel [%(default)s]")
    parser.set_defaults(repeat=5, rounds=1, warmup=1)


def scenes_of(arguments):
    """{name: as --scene takes it}"""
    scenes = QUICK if arguments.quick else [*SCENES, *scene_files(arguments)]
    return {short_name(scene): shlex.quote(scene) for scene in scenes}


def configurations(arguments, _device):
    size, spp = (24, 2) if arguments.quick else (arguments.size, arguments.spp)
    return [Configuration(
        f"{name}: {variant}",
        f"--mode wavefront --scene {scene} --width {size} --height {size} --spp {spp} "
        f"--max-depth 8 --builder hploc {options}",
        {"panel": "", "series": variant, "x": name, "variant": variant,
         **{f"mrays_{part}": "" for part in PARTS}, **ratio_labels()},
        same_image=name if variant in (BASE, "custom") else "")
        for name, scene in scenes_of(arguments).items() for variant, options in VARIANTS.items()]


def scene_of(row):
    return row["x"]


def traced_ms(row, part):
    return sum(float(row.get(f"{stage}_ms_{part}") or 0) for stage in ("intersect", "shadow"))


def finish(rows, _arguments):
    set_ratios(rows, BASE, scene_of)
    for row in rows:
        rays = int(row["rays"]) + int(row["shadow_rays"] or 0)
        for part, time in PARTS.items():
            if milliseconds := traced_ms(row, time):
                row[f"mrays_{part}"] = f"{1e-3 * rays / milliseconds:.6g}"


def conclude(rows, _arguments):
    """For each scene: OptiX's speed by kind of hits, ours being 1."""
    sentences = []
    for scene in dict.fromkeys(scene_of(row) for row in rows):
        ratios = [f"{row['variant']} {float(row['ratio_median']):.2f}" for row in rows
                  if scene_of(row) == scene and row["variant"] != BASE and row["ratio_median"]]
        if ratios:
            sentences.append(f"{scene}: with OptiX a render is so many times as fast as with our tracer: "
                             + ", ".join(ratios))
    return sentences


EXPERIMENT = Experiment(
    "hardware", __doc__.splitlines()[0], configurations,
    Plot("bars", "Rays traced by OptiX and by our warps (an H100 or H200 has no RT cores)",
         "scene", "million rays per second of tracing", y="mrays", log_y=False),
    add_arguments=add_arguments, finish=finish, conclude=conclude, needs_gpu=True,
    table=("mrays_median", "ratio_median"))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
