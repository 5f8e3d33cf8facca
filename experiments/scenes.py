#!/usr/bin/env python3
"""Scenes: which mode and which structure render scenes made of triangles fastest?

Also the promises for one H200: the Cornell box and a statue of a million triangles. Scene files may
be named as further arguments of --scenes.
"""
import sys

import harness
from harness import Configuration, Experiment, Plot
from promises import judge_best
from scene_files import add_scene_files, scene_files, short_name

# scene, size, samples, and the promise in 10^6 samples/s that the better mode keeps
BUILT_IN = [("cornell", 1024, 64, 1000), ("statue:1M", 1024, 32, 600), ("boxes", 1024, 32, None),
            ("instances:10K", 1024, 16, None), ("terrain:10M", 1024, 16, None)]
STRUCTURES = {"cornell": ["brute", "bvh2"]}  # quads; else:
TRIANGLES = ["bvh2", "cwbvh"]
DEPTH = 8


def configurations(arguments, device):
    scenes = BUILT_IN + [(path, 1024, 64, None) for path in scene_files(arguments)]
    if arguments.quick:
        scenes = [(scene.replace("M", "K").replace("10K", "10"), size // 32, 2, target)
                  for scene, size, _, target in scenes]
    builders = ["sah", "hploc"] if device.kind == "cuda" else ["sah"]
    rows = []
    for scene, size, spp, target in scenes:
        name = short_name(scene)
        for mode in ["megakernel", "wavefront"]:
            for accel in STRUCTURES.get(scene, TRIANGLES):
                for builder in builders:
                    if builder != "sah" and scene in STRUCTURES:
                        continue
                    has_triangles = scene not in STRUCTURES
                    label = f"{accel}, {builder}" if has_triangles else accel
                    chosen = f"--builder {builder} " if has_triangles else ""
                    rows.append(Configuration(
                        f"{name}: {mode}, {label}",
                        f"--mode {mode} --scene {scene} --accel {accel} {chosen}"
                        f"--width {size} --height {size} --spp {spp} --max-depth {DEPTH}",
                        {"panel": name, "x": f"{mode}, {label}",
                         "target_msamples_per_s": target or "", "verdict": ""},
                        same_image=name))
    return rows


EXPERIMENT = Experiment(
    "scenes", __doc__.splitlines()[0], configurations,
    Plot("bars", "Scenes of triangles: 1024 x 1024, depth 8", log_y=False),
    add_arguments=add_scene_files, finish=judge_best,
    table=("mpaths_per_s", "target_msamples_per_s", "verdict"))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
