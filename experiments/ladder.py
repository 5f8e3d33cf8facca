#!/usr/bin/env python3
"""Ladder: from the megakernel to the wavefront step by step: what does each step give?

Each step has the options of the one before it and one more; `gain` is the time of the step before,
divided by its own. The lowest is the megakernel at its best, with the structure and the kernel that
it takes by itself; the next one is plain, as the wavefront's first step is. The pool has 1M paths
up to the last steps, because regeneration matters where slots are used again; triangles are in a
binary tree up to there.
"""
import shlex
import sys

from lib import harness
from lib.harness import Configuration, Experiment, Plot
from lib.image_check import with_options
from lib.images import images_of
from lib.scene_files import add_scene_files
from lib.sentences import against, in_groups, time_of

CUDA, TRIANGLES, SPHERES = "a GPU", "triangles", "spheres"
# (step, what changes against the one before, what it needs)
STEPS = [
    ("SoA instead of AoS", "--layout soa", ()),
    ("compaction", "--compaction atomic", ()),
    ("material order", "--order-surfaces on", ()),
    ("whole rays in sectors", "--layout sectors", ()),
    ("regeneration", "--regenerate on", ()),
    ("CUDA graph", "--schedule graph", (CUDA,)),
    ("last paths in one kernel", "--finish-paths 131072", ()),
    ("pool of the whole batch", "--pool-size auto", ()),
    ("wide tree", "--accel cwbvh --persistent off", (CUDA, TRIANGLES)),
    ("persistent warps", "--persistent on", (CUDA, TRIANGLES)),
]
# Above all of them, for spheres. Fused stages sort no hits.
FUSED = [("fused stages", "--stages fused --wave-rays 1 --order-surfaces off"),
         ("two rays a wave", "--wave-rays 2")]
PLAIN = ("--mode wavefront --stages split --compaction none --regenerate off "
         "--finish-paths 0 --schedule host --pool-size 1M "
         "--order-surfaces off")
QUICK = "--pool-size 256"


def steps_of(scene, device):
    """(step, options besides the image's) from the lowest to the highest."""
    has = [CUDA] * (device.kind == "cuda") + [SPHERES if scene == "spheres" else TRIANGLES]
    tree = "--accel bvh2" if TRIANGLES in has else ""
    if TRIANGLES in has:
        yield "megakernel at its best", "--mode megakernel"
    yield "megakernel", f"--mode megakernel {tree}"
    options = f"{PLAIN} {tree}"
    yield "split kernels", f"{options} --layout aos"
    for step, change, needs in STEPS:
        if set(needs) <= set(has):
            options = " ".join(with_options(options, change))
            yield step, options
    for step, change in FUSED if SPHERES in has else []:
        options = " ".join(with_options(options, change))
        yield step, options


def configurations(arguments, device):
    def quick(options):
        return QUICK if arguments.quick and "--mode wavefront" in options else ""
    return [Configuration(
        f"{scene}: {number} {step}", shlex.join(with_options(f"{image} {options}", quick(options))),
        {"panel": scene, "x": f"{number} {step}", "gain": ""}, same_image=scene)
            for scene, image in images_of(arguments).items()
            for number, (step, options) in enumerate(steps_of(scene, device))]


def steps(rows):
    """(row, the row of the measured step before it)"""
    for mine in in_groups(rows, "panel").values():
        yield from zip(mine[1:], mine)


def finish(rows, _arguments):
    for row, before in steps(rows):
        row["gain"] = f"{time_of(before).middle / time_of(row).middle:.3f}"


def conclude(rows, _arguments):
    lines = [f"{row['panel']}: {row['x']}: {against(before, row, before['x'])}"
             for row, before in steps(rows)]
    for scene, mine in in_groups(rows, "panel").items():
        if len(mine) > 1:
            lines.append(f"{scene}, all steps together: "
                         f"{against(mine[0], mine[-1], mine[0]['x'])}")
    return lines


EXPERIMENT = Experiment(
    "ladder", __doc__.splitlines()[0], configurations,
    Plot("bars", "The ladder from the megakernel to the wavefront", log_y=False),
    add_arguments=add_scene_files, finish=finish, conclude=conclude, table=("gain",))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
