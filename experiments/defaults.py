#!/usr/bin/env python3
"""By itself: how fast is each mode with nothing but its defaults, scene by scene?

The program chooses structure, kernel, stages and pool. What a user gets who names a scene and a
mode, and the table to compare two devices by: `scripts/report results/a results/b`.
"""
import sys

import harness
from harness import Configuration, Experiment, Plot
from scene_files import add_scene_files, scene_files, short_name
from sentences import against, in_groups

MODES = ["megakernel", "wavefront"]
# scene, width, height, samples, depth: the paper's images, then scenes of quads and triangles
BUILT_IN = [("spheres", 600, 300, 50, 50), ("spheres", 2400, 1200, 50, 50),
            *((scene, 1024, 1024, 64, 8) for scene in (
                "cornell", "statue:1M", "terrain:1M", "boxes", "instances:10K", "instances:1M",
                "dial:16:0:closed"))]


def add_arguments(parser):
    add_scene_files(parser)
    parser.set_defaults(rounds=2)


def configurations(arguments, _device):
    scenes = BUILT_IN + [(path, 1024, 1024, 64, 8) for path in scene_files(arguments)]
    if arguments.quick:
        scenes = [(scene.replace("1M", "1K").replace("10K", "10"), width // 32, height // 32, 2,
                   depth) for scene, width, height, _, depth in scenes]
    return [Configuration(
        f"{short_name(scene)} {width}x{height}: {mode}",
        f"--mode {mode} --scene {scene} --width {width} --height {height} --spp {spp} "
        f"--max-depth {depth}",
        {"panel": f"{short_name(scene)} {width}x{height}", "x": mode},
        same_image=f"{short_name(scene)} {width}x{height}")
            for scene, width, height, spp, depth in scenes for mode in MODES]


def conclude(rows, _arguments):
    lines = []
    for scene, mine in in_groups(rows, "panel").items():
        of_mode = {row["mode"]: row for row in mine}
        if len(of_mode) == len(MODES):
            lines.append(f"{scene}, wavefront: " + against(
                of_mode["megakernel"], of_mode["wavefront"], "the megakernel"))
    return lines


EXPERIMENT = Experiment(
    "defaults", __doc__.splitlines()[0], configurations,
    Plot("bars", "Each mode by its defaults"), add_arguments=add_arguments,
    conclude=conclude, table=("mpaths_per_s", "used_accel"))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
