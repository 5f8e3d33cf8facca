#!/usr/bin/env python3
"""Process: where does its wall time go, from Enter to picture?

Each row is a command as a user types it: by default options, with a PNG (--picture), one render
without warm-up. Every round starts a process for it (--repeat and --warmup mean nothing here).
`best` names the builder of the tree instead of `auto`. The wall time is measured from outside, from
fork to exit, and is the sum of the parts: ptexp's own (docs/statistics.md), of which `render` is
divided into kernels and the rest, and `end`, from the statistics to the exit.

Scene files are warm, read by the harness just before the process, or cold: posix_fadvise(DONTNEED)
has dropped the files in the scene's folder from the page cache, which needs no root. The program and
its libraries are warm always.

What any process takes: `ptexp --list-devices` (the driver begins, without a context) and a render of
one pixel, whose part `driver and devices` is the driver's begin and whose `context and upload` is
the wait for the context; on a GPU also an empty CUDA program, which Python runs
(lib/empty_cuda.py): Python's own time is another row and is taken off.
"""
import shlex
import sys
from functools import partial

from lib import harness, page_cache
from lib.harness import Configuration, Experiment, Plot, ROOT
from lib.promises import judge_overheads
from lib.scene_files import add_scene_files, scene_files, short_name
from lib.sentences import against, in_groups, interval, listed, show, with_interval

WALL = "process_wall_ms"
PARTS = {"start": "start", "devices": "driver and devices", "scene": "reading",
         "prepare": "plan and trees", "setup": "context and upload", "kernels": "kernels",
         "render_rest": "rest of render", "image": "image", "end": "end",
         "undivided": "not divided"}
# scene, width, height, samples, depth: the paper's image, then triangles
BUILT_IN = [("spheres", 600, 300, 50, 50),
            *((scene, 1024, 1024, 64, 8) for scene in (
                "statue:1M", "statue:4M", "terrain:10M", "instances:10K", "boxes"))]
NO_TRIANGLES = ["spheres"]
# (scene, samples): ms beyond its kernels and an empty CUDA program, on one H100 or H200
GOALS = {("spheres", 50): 40, ("statue:1M", 64): 150, ("statue:4M", 64): 300,
         ("terrain:10M", 64): 450, ("grey-white-room/scene.xml", 64): 300,
         ("modern-hall/scene.xml", 1): 110}
EMPTY, PYTHON = "empty CUDA program, by Python", "Python alone"
ANY = "any process"  # `image` of rows that no scene has
LARGEST = 3  # parts that a sentence names


def add_arguments(parser):
    add_scene_files(parser)
    parser.add_argument("--samples", metavar="N", nargs="+", type=int, default=[1, 64],
                        help="samples per pixel of scene files, a row for each [1 64]")
    parser.add_argument("--picture", metavar="NAME", default="image.png",
                        help="what each process writes; its ending is the format [%(default)s]")
    parser.set_defaults(rounds=5)


def images_of(arguments):
    """(scene, width, height, samples, depth, whether it is a file)"""
    images = [(*image, False) for image in BUILT_IN]
    images += [(path, 1024, 1024, spp, 8, True) for path in scene_files(arguments)
               for spp in arguments.samples]
    if arguments.quick:
        images = [(scene if is_file else scene.replace("M", "K").replace("10K", "10"), width // 32,
                   height // 32, min(spp, 2), depth, is_file)
                  for scene, width, height, spp, depth, is_file in images]
    return list(dict.fromkeys(images))


def labels(image, variant, files="", goal_ms=""):
    return {"panel": "", "x": ", ".join(filter(None, [image * (image != ANY), variant,
                                                      files and f"{files} files"])),
            "image": image, "variant": variant, "files": files, "goal_ms": goal_ms, "over_ms": "",
            "verdict": ""}


def any_process(device, picture):
    """What the scenes' rows are held against."""
    def command(name, arguments, **more):
        return Configuration(name, arguments, labels(ANY, name), renders=False, **more)
    rows = [command("ptexp --list-devices", "--list-devices")]
    if device.kind == "cuda":
        script = f"-I -S {shlex.quote(str(ROOT / 'experiments' / 'lib' / 'empty_cuda.py'))}"
        number = device.choice.partition(":")[2] or "0"
        rows += [command(PYTHON, script, program=sys.executable),
                 command(EMPTY, f"{script} {number}", program=sys.executable)]
    return [*rows, Configuration(
        "one pixel", "--scene spheres --spheres 1 --width 1 --height 1 --spp 1 --max-depth 1",
        labels(ANY, "one pixel"), image=picture)]


def variants_of(scene, is_file):
    """(builder, files)"""
    if is_file:
        return [("auto", "warm"), ("auto", "cold"), ("best", "warm")]
    return [("auto", "")] + [("best", "")] * (scene not in NO_TRIANGLES)


def configurations(arguments, device):
    rows = any_process(device, arguments.picture)
    for scene, width, height, spp, depth, is_file in images_of(arguments):
        name = f"{short_name(scene)}, {spp} sample{'s' * (spp != 1)}"
        for builder, files in variants_of(scene, is_file):
            goal = GOALS.get((short_name(scene), spp), "") if builder == "auto" else ""
            made = labels(name, builder, files, goal if files != "cold" else "")
            rows.append(Configuration(
                made["x"], f"--scene {shlex.quote(scene)} --width {width} --height {height} "
                f"--spp {spp} --max-depth {depth}" + " --builder best" * (builder == "best"), made,
                image=arguments.picture, same_image=short_name(scene),
                prepare=partial(page_cache.drop if files == "cold" else page_cache.fill, scene)
                if is_file else None))
    for row in rows:
        row.repeat = arguments.rounds  # one of each round
    return rows


def empty_ms(rows):
    """Of an empty CUDA program; None where there is none."""
    walls = {row["name"]: float(row[WALL]) for row in rows if row["name"] in (EMPTY, PYTHON)}
    return walls[EMPTY] - walls[PYTHON] if len(walls) == 2 else None


def finish(rows, arguments):
    judge_overheads(rows, WALL, empty_ms(rows), arguments)


def about_parts(row):
    """'kernels 12 %, ...': the kernels' share, then the largest others."""
    wall = float(row[WALL])
    parts = {name: float(row[f"process_{part}_ms"]) for part, name in PARTS.items()
             if row.get(f"process_{part}_ms")}
    kernels = parts.pop(PARTS["kernels"], None)
    largest = sorted(parts, key=parts.get, reverse=True)[:LARGEST]
    found = [] if kernels is None else [f"kernels {show(kernels)} ms ({100 * kernels / wall:.0f} %)"]
    return listed([*found, *(f"{name} {100 * parts[name] / wall:.0f} %" for name in largest)])


def about(row):
    text = f"{row['x']}: {with_interval(interval(row, WALL), 'ms')}"
    if row.get("process_kernels_ms"):
        text += f", of it {about_parts(row)}"
    if row["over_ms"]:
        text += f"; {show(float(row['over_ms']))} ms over its kernels and an empty CUDA program"
    if row["verdict"]:
        text += f" (goal {row['goal_ms']} ms: {row['verdict']})"
    return text


def conclude(rows, _arguments):
    lines = []
    empty = empty_ms(rows)
    if empty is not None:
        lines.append(f"an empty CUDA program without Python: {show(empty)} ms")
    for image, mine in in_groups(rows, "image").items():
        lines += map(about, mine)
        of = {(row["variant"], row["files"] or "warm"): row for row in mine}
        auto = of.get(("auto", "warm"))
        if auto and ("best", "warm") in of:
            lines.append(f"{image}, builder auto: {against(of['best', 'warm'], auto, 'best', WALL)}")
        if auto and ("auto", "cold") in of:
            lines.append(f"{image}, cold files: {against(auto, of['auto', 'cold'], 'warm ones', WALL)}")
    return lines


EXPERIMENT = Experiment(
    "process_time", __doc__.splitlines()[0], configurations,
    Plot("stack", "The wall time of whole processes", y_label="wall time [ms]", y=WALL, log_y=False,
         parts=tuple((f"process_{part}_ms", name) for part, name in PARTS.items())),
    add_arguments, finish, (WALL, "over_ms", "goal_ms", "verdict"), conclude, whole_process=True)

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
