#!/usr/bin/env python3
"""Scenes: which mode and which structure render scenes made of triangles fastest?

Also the promises for one H200: the Cornell box and a statue of a million triangles. Scene files may
be named as further arguments of --scenes.
"""
import shlex
import sys

from lib import harness
from lib.harness import Configuration, Experiment, Plot
from lib.promises import judge_best
from lib.scene_files import add_scene_files, scene_files, short_name
from lib.sentences import against, against_megakernel, fastest, in_groups

# scene, size, samples, and the promise in 10^6 samples/s that the better mode keeps
BUILT_IN = [("cornell", 1024, 64, 1000), ("statue:1M", 1024, 32, 600), ("boxes", 1024, 32, None),
            ("instances:10K", 1024, 16, None), ("terrain:10M", 1024, 16, None)]
QUADS = ["cornell"]
# H-PLOC, which needs a GPU, builds the structure that suits the mode.
SUITABLE = {"megakernel": "bvh2", "wavefront": "cwbvh"}
# As the modes are usually written: a pixel for each thread; a selection before each stage, launched
# by the host up to the last ray, and surfaces in any order. A binary tree in both.
USUAL = {"megakernel": "--work pixel",
         "wavefront": "--compaction cub --schedule host --finish-paths 0 --stages split --order-surfaces off"}
DEPTH = 8


def ways_of(scene, mode, device):
    """{way: options}"""
    if scene in QUADS:
        ways = {"brute": "--accel brute", "bvh2": "--accel bvh2"}
    else:
        ways = {f"{accel}, sah": f"--accel {accel} --builder sah" for accel in ("bvh2", "cwbvh")}
        if device.kind == "cuda":
            ways[f"{SUITABLE[mode]}, hploc"] = f"--accel {SUITABLE[mode]} --builder hploc"
    if scene not in QUADS:
        ways["by itself"] = ""  # the structure, builder and kernel that the program takes
    return {**ways, "as usually written": f"--accel bvh2 {USUAL[mode]}"}


def same_image(scene, options):
    """One hit for every structure (docs/design/tracing.md) holds for triangles."""
    return f"{scene}, {'bvh2' if 'bvh2' in options else 'brute'}" if scene in QUADS else scene


def configurations(arguments, device):
    scenes = BUILT_IN + [(path, 1024, 16, None) for path in scene_files(arguments)]
    if arguments.quick:
        scenes = [(scene.replace("M", "K").replace("10K", "10"), size // 32, 2, target)
                  for scene, size, _, target in scenes]
    return [Configuration(
        f"{short_name(scene)}: {mode}, {way}",
        f"--mode {mode} --scene {shlex.quote(scene)} {options} --width {size} --height {size} --spp {spp} "
        f"--max-depth {DEPTH}",
        {"panel": short_name(scene), "x": f"{mode}, {way}", "target_msamples_per_s": target or "",
         "verdict": ""}, same_image=same_image(short_name(scene), options))
            for scene, size, spp, target in scenes for mode in USUAL
            for way, options in ways_of(scene, mode, device).items()]


def conclude(rows, _arguments):
    """The modes against each other, at their best and as usually written."""
    lines = []
    for scene, mine in in_groups(rows, "panel").items():
        usual = {row["mode"]: row for row in mine if row["x"].endswith("as usually written")}
        best = {mode: fastest([row for row in of_mode if row not in usual.values()])[0]
                for mode, of_mode in in_groups(mine, "mode").items()
                if any(row not in usual.values() for row in of_mode)}
        for how, pair in (("both at their best", best), ("both as usually written", usual)):
            lines += against_megakernel(f"{scene}, {how}", pair)
        lines += [f"{scene}, {mode} at its best: {against(usual[mode], row, 'what is usual')}"
                  for mode, row in best.items() if mode in usual]
    return lines


EXPERIMENT = Experiment(
    "scenes", __doc__.splitlines()[0], configurations,
    Plot("bars", "Scenes of triangles: 1024 x 1024, depth 8", log_y=False),
    add_arguments=add_scene_files, finish=judge_best,
    conclude=conclude, table=("mpaths_per_s", "target_msamples_per_s", "verdict"))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
