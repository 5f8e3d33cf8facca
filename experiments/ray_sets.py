#!/usr/bin/env python3
"""Ray sets: which structure, builder and way of tracing are fastest for which kind of rays?

Makes sets of rays by `ptexp rays` and traces them by `ptexp trace` (docs/tracing.md). Mesh or scene
files may be named by --scenes.
"""
import csv
import os
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

import harness
from harness import Experiment, HarnessError

# What a built-in scene is looked at from; files have cameras of their own.
TERRAIN_CAMERA = "--look-from -490,175,490 --look-at 0,10,0 --vfov 38"
BUILT_IN = [("terrain:10M", TERRAIN_CAMERA), ("statue:1M", "")]
KINDS = ["primary", "ao", "diffuse"]
PATHS = ["bounce:0", "bounce:1", "bounce:3"]  # of scene files, which have materials
CPU = [("bvh2", "sah", ""), ("cwbvh", "sah", ""), ("cwbvh", "sbvh", "")]
CUDA = [("bvh2", "sah", "threads"), ("cwbvh", "sah", "threads"), ("cwbvh", "sah", "persistent"),
        ("cwbvh", "sah", "beam"), ("cwbvh", "sbvh", "auto"), ("cwbvh", "hploc", "auto")]


def add_arguments(parser):
    parser.add_argument("--scenes", nargs="*", default=[], metavar="FILE",
                        help="meshes (.mesh) and scenes to measure besides the built-in ones")
    parser.add_argument("--size", type=int, default=2048, metavar="N",
                        help="rays are those of an image of N x N pixels [%(default)s]")


def ptexp(program, command, timeout_s):
    try:
        run = subprocess.run([str(program), *command], capture_output=True, text=True, check=False,
                             stdin=subprocess.DEVNULL, timeout=timeout_s)
    except subprocess.TimeoutExpired:
        raise HarnessError(f"no end after {timeout_s:g} s: {shlex.join(command)}") from None
    if run.returncode != 0:
        raise HarnessError(f"exit code {run.returncode}: {shlex.join(command)}: "
                           f"{run.stderr.strip()}")


def name_of(scene):
    """modern-hall for .../modern-hall/scene.xml, bunny_room for .../bunny_room.mesh."""
    path = Path(scene).resolve()
    return path.parent.name if path.stem == "scene" else path.stem


def ray_sets(device, arguments, folder):
    """For every set of rays: its file, the command that makes it, and those that trace it."""
    scenes = [(scene, "") for scene in arguments.scenes] + BUILT_IN
    size = arguments.size
    if arguments.quick:
        scenes, size = [("terrain:2K", TERRAIN_CAMERA), ("statue:2K", "")], 32
    for scene, camera in scenes:
        for kind in KINDS + (PATHS if scene.endswith((".xml", ".gltf", ".glb")) else []):
            rays = str(Path(folder, f"{name_of(scene)}.{kind}.rays".replace(":", "")))
            make = ["rays", "--scene", scene, "--kind", kind, "--size", str(size),
                    *camera.split(), "--output", rays]
            traces = [["trace", "--quiet", "--mesh", scene, "--rays", rays, "--accel", accel,
                       "--builder", builder, *(["--variant", variant] if variant else []),
                       "--device", device.choice, "--repeat", str(arguments.repeat),
                       "--warmup", str(arguments.warmup), "--csv", str(Path(folder, "rows.csv"))]
                      for accel, builder, variant in (CUDA if device.kind == "cuda" else CPU)]
            yield rays, make, traces


def measure(program, device, arguments, folder):
    """A row for every set of rays and way to trace it."""
    for rays, make, traces in ray_sets(device, arguments, folder):
        for command in [make, *traces]:
            ptexp(program, command, arguments.timeout)
        os.unlink(rays)
        print(Path(rays).name, flush=True)
    with open(Path(folder, "rows.csv"), newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for row in rows:  # not where it was measured
        row["ray_file"] = Path(row["ray_file"]).name
        row["mesh"] = "/".join(p for p in Path(row["mesh"]).parts[-2:] if p != "..")
        row["command"] = row["command"].replace(f"{folder}/", "")
    return [{"experiment": EXPERIMENT.name, "status": "measured", **row} for row in rows]


def run(experiment, arguments):
    program = harness.find_program(arguments.ptexp)
    device = harness.find_device(program, arguments.device)
    if arguments.list:
        for _, make, traces in ray_sets(device, arguments, "."):
            for command in [make, *traces]:
                print(shlex.join([str(program), *command]))
        return
    path = harness.table_path(experiment, device, arguments)
    with tempfile.TemporaryDirectory(prefix="ptexp-") as folder:
        rows = measure(program, device, arguments, folder)
    harness.write_table(path, rows, harness.provenance(experiment, program, device, arguments))
    for row in rows:
        print(f"{row['ray_file']:40} {row['accel']:6} {row['builder']:6} {row['variant']:10} "
              f"{float(row['mrays_per_s']):10.1f} Mrays/s")
    print(f"\nwrote {path}")


EXPERIMENT = Experiment("ray_sets", __doc__.splitlines()[0], None, None,
                        add_arguments=add_arguments)

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT, runner=run))
