#!/usr/bin/env python3
"""Hardware: what does OptiX change about rays and whole paths, and what do equal hits cost there?

Four architectures: the wavefront traces its queues by our persistent warps or by OptiX, all other stages
being the same; the megakernel is our own kernel or OptiX's ray generation program, which can also reorder
its threads (`reorder`), as `--kernel sort` does in software. The host launches the waves in all rows, and no
path is finished outside of them. `mrays_*` is rays and shadow rays per second of the stages that trace
(10^6/s; wavefront), `ratio_*` our wavefront's time of the whole render divided by the row's, `registers` those
of a thread of our megakernel (OptiX tells none; PTEXP_OPTIX_LOG=4 prints what it compiles). Images of all
rows but `any-hit` and `built-in` are compared with ours first; those may differ in some pixels, and their
ratios are of times per ray, since their paths may have some other rays. A GPU without
RT cores (an H100 or H200 has none) runs OptiX by software and reorders nothing: then a row says nothing of
hardware.
"""
import shlex
import sys

from lib import harness
from lib.harness import Configuration, Experiment, Plot
from lib.kernels import kernels_of
from lib.options import add_image_options
from lib.ratios import ratio_labels, rays_of, set_ratios
from lib.scene_files import add_scene_files, scene_files, short_name

BASE = "ours"
WAVEFRONT = "--mode wavefront"
MEGAKERNEL = "--mode megakernel"
VARIANTS = {BASE: f"{WAVEFRONT} --accel cwbvh --schedule host --finish-paths 0",
            "custom": f"{WAVEFRONT} --accel optix --optix-hits custom",
            "any-hit": f"{WAVEFRONT} --accel optix --optix-hits any-hit",
            "built-in": f"{WAVEFRONT} --accel optix --optix-hits built-in",
            "megakernel loop": f"{MEGAKERNEL} --kernel loop",
            "megakernel sort": f"{MEGAKERNEL} --kernel sort",
            "megakernel custom": f"{MEGAKERNEL} --accel optix --optix-hits custom",
            "megakernel custom, reorder": f"{MEGAKERNEL} --accel optix --optix-hits custom --reorder on",
            "megakernel built-in": f"{MEGAKERNEL} --accel optix --optix-hits built-in",
            "megakernel built-in, reorder": f"{MEGAKERNEL} --accel optix --optix-hits built-in --reorder on"}
SCENES = ["statue:1M", "terrain:1M", "boxes", "instances:100K", "dial:16:0.5:closed"]
QUICK = ["statue:3K", "instances:20"]
PARTS = {"median": "median", "min": "max", "max": "min"}


def has_other_hits(variant):
    """Whether OptiX decides, so that some pixels, and the rays of their paths, may be others."""
    return "any-hit" in variant or "built-in" in variant


def add_arguments(parser):
    add_scene_files(parser)
    add_image_options(parser, spp=8)
    parser.set_defaults(repeat=5, rounds=1, warmup=1)


def scenes_of(arguments):
    """{name: as --scene takes it}"""
    scenes = QUICK if arguments.quick else [*SCENES, *scene_files(arguments)]
    return {short_name(scene): shlex.quote(scene) for scene in scenes}


def configurations(arguments, _device):
    size, spp = (24, 2) if arguments.quick else (arguments.size, arguments.spp)
    return [Configuration(
        f"{name}: {variant}",
        f"--scene {scene} --width {size} --height {size} --spp {spp} "
        f"--max-depth 8 --builder hploc {options}",
        {"panel": name, "series": variant, "x": variant, "variant": variant,
         **{f"mrays_{part}": "" for part in PARTS}, **ratio_labels(), "registers": ""},
        same_image="" if has_other_hits(variant) else name)
        for name, scene in scenes_of(arguments).items() for variant, options in VARIANTS.items()]


def scene_of(row):
    return row["panel"]


def traced_ms(row, part):
    return sum(float(row.get(f"{stage}_ms_{part}") or 0) for stage in ("intersect", "shadow"))


def finish(rows, _arguments):
    set_ratios(rows, BASE, scene_of, lambda row: has_other_hits(row["variant"]))
    for row in rows:
        for part, time in PARTS.items():
            if milliseconds := traced_ms(row, time):
                row[f"mrays_{part}"] = f"{1e-3 * rays_of(row) / milliseconds:.6g}"
        if kernel := kernels_of(row).get("megakernel"):
            row["registers"] = str(kernel.registers)


def conclude(rows, _arguments):
    """For each scene: the variants' speed, our wavefront's being 1."""
    sentences = []
    for scene in dict.fromkeys(scene_of(row) for row in rows):
        ratios = [f"{row['variant']} {float(row['ratio_median']):.2f}" for row in rows
                  if scene_of(row) == scene and row["variant"] != BASE and row["ratio_median"]]
        if ratios:
            sentences.append(f"{scene}: a render is so many times as fast as by our wavefront: "
                             + ", ".join(ratios))
    return sentences


EXPERIMENT = Experiment(
    "hardware", __doc__.splitlines()[0], configurations,
    Plot("bars", "Renders with OptiX and without (an H100 or H200 has no RT cores)",
         "", "times as fast as our wavefront", y="ratio", log_y=False),
    add_arguments=add_arguments, finish=finish, conclude=conclude, needs_gpu=True,
    table=("mrays_median", "ratio_median", "registers"))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
