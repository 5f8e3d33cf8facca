#!/usr/bin/env python3
"""Shading: does it pay to order the queue of surfaces by BSDF type?

The wavefront with and without the order, beside the megakernel. Scene files may be named as
further arguments of --scenes.
"""
import shlex
import sys

from lib import harness
from lib.harness import Configuration, Experiment, Plot
from lib.promises import judge_best
from lib.scene_files import add_scene_files, scene_files, short_name
from lib.sentences import against, in_groups

# scene, samples, and the promise in 10^6 samples/s that the best way keeps on an H200
BUILT_IN = [("cornell", 64, None), ("statue:1M", 64, None), ("dial:16:0:closed", 16, None)]
PROMISES = {"modern-hall/scene.xml": 430, "grey-white-room/scene.xml": 300}
WAYS = {
    "megakernel": "--mode megakernel",
    "uber": "--mode wavefront --stages split --order-surfaces off",
    "uber, sorted": "--mode wavefront --stages split --order-surfaces on",
}
SIZE, DEPTH = 1024, 8


def configurations(arguments, _device):
    scenes = BUILT_IN + [(path, 64, PROMISES.get(short_name(path)))
                         for path in scene_files(arguments)]
    size = SIZE
    if arguments.quick:
        scenes = [(scene.replace("1M", "1K"), 2, promise) for scene, _, promise in scenes]
        size = SIZE // 32
    rows = []
    for scene, spp, promise in scenes:
        name = short_name(scene)
        for way, options in WAYS.items():
            rows.append(Configuration(
                f"{name}: {way}",
                f"--scene {shlex.quote(scene)} --width {size} --height {size} --spp {spp} "
                f"--max-depth {DEPTH} {options}",
                {"panel": name, "x": way, "target_msamples_per_s": promise or "", "verdict": ""},
                same_image=name))
    return rows


def conclude(rows, _arguments):
    """Each way against one kernel for all materials in any order."""
    lines = []
    for scene, mine in in_groups(rows, "panel").items():
        plain = next((row for row in mine if row["x"] == "uber"), None)
        lines += [f"{scene}, {row['x']}: {against(plain, row, 'uber')}"
                  for row in mine if plain and row is not plain]
    return lines


EXPERIMENT = Experiment(
    "shading", __doc__.splitlines()[0], configurations,
    Plot("bars", "Ways to shade: 1024 x 1024, depth 8", log_y=False),
    add_arguments=add_scene_files, finish=judge_best,
    conclude=conclude, table=("mpaths_per_s", "target_msamples_per_s", "verdict"))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
