#!/usr/bin/env python3
"""By itself: how fast is each mode with nothing but its defaults, scene by scene?

The program chooses structure, kernel, stages and pool. What a user gets who names a scene and a
mode, and the table to compare two devices by: `scripts/report results/a results/b`. `--only my.xml`
asks for one's own scene alone, at its own size and depth, in a table of its own.
"""
import shlex
import sys
from pathlib import Path

from lib import harness
from lib.description import HarnessError
from lib.harness import Configuration, Experiment, Plot
from lib.scene_files import add_scene_files, scene_files, short_name
from lib.sentences import against_megakernel, in_groups

MODES = ["megakernel", "wavefront"]
# scene, width, height, samples, depth: the paper's images, then scenes of quads and triangles
BUILT_IN = [("spheres", 600, 300, 50, 50), ("spheres", 2400, 1200, 50, 50),
            *((scene, 1024, 1024, 64, 8) for scene in (
                "cornell", "statue:1M", "terrain:1M", "boxes", "instances:10K", "instances:1M",
                "dial:16:0:closed"))]


OWN_SPP = 64  # of a file of --only: its own may be for a picture, and take hours


def add_arguments(parser):
    add_scene_files(parser)
    parser.add_argument("--only", nargs="+", default=[], metavar="FILE|SCENE",
                        help="measure these scenes alone: built-in ones as ever, files at their own "
                             f"size and depth with {OWN_SPP} samples; labelled 'only' unless --label "
                             "is given")
    parser.set_defaults(rounds=2)


def own_scenes(arguments):
    """[(file, name)] of --only. Raises HarnessError for what is neither a file nor a scene."""
    built_in, own = {scene for scene, *_ in BUILT_IN}, []
    for name in arguments.only:
        if Path(name).is_file():
            own.append((str(Path(name).resolve()), short_name(Path(name).resolve())))
        elif name not in built_in:
            raise HarnessError(f"--only {name}: no such file, and no scene of the experiment; expected "
                               f"a scene file or some of {', '.join(sorted(built_in))}")
    return own


def own_configurations(arguments):
    size = "--width 32 --height 32 --spp 2" if arguments.quick else f"--spp {OWN_SPP}"
    return [Configuration(f"{name}: {mode}", f"--mode {mode} --scene {shlex.quote(path)} {size}",
                          {"panel": name, "x": mode}, same_image=name)
            for path, name in own_scenes(arguments) for mode in MODES]


def configurations(arguments, _device):
    scenes = BUILT_IN + [(shlex.quote(path), 1024, 1024, 64, 8) for path in scene_files(arguments)]
    own = own_configurations(arguments)
    if arguments.only:
        scenes = [scene for scene in BUILT_IN if scene[0] in arguments.only]
    if arguments.quick:
        scenes = [(scene.replace("1M", "1K").replace("10K", "10"), width // 32, height // 32, 2,
                   depth) for scene, width, height, _, depth in scenes]
    return own + [Configuration(
        f"{short_name(scene)} {width}x{height}: {mode}",
        f"--mode {mode} --scene {scene} --width {width} --height {height} --spp {spp} "
        f"--max-depth {depth}",
        {"panel": f"{short_name(scene)} {width}x{height}", "x": mode},
        same_image=f"{short_name(scene)} {width}x{height}")
            for scene, width, height, spp, depth in scenes for mode in MODES]


def conclude(rows, _arguments):
    lines = []
    for scene, mine in in_groups(rows, "panel").items():
        lines += against_megakernel(scene, {row["mode"]: row for row in mine})
    return lines


EXPERIMENT = Experiment(
    "defaults", __doc__.splitlines()[0], configurations,
    Plot("bars", "Each mode by its defaults"), add_arguments=add_arguments,
    conclude=conclude, table=("mpaths_per_s", "used_accel"))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
