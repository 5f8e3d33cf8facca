#!/usr/bin/env python3
"""Ray sets: which structure, builder and way of tracing are fastest for which kind of rays?

Makes sets of rays by `ptexp rays` and traces them by `ptexp trace` (docs/tracing.md). Mesh or scene
files may be named by --scenes.
"""
import csv
import datetime
import json
import os
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

import harness
from harness import Experiment, HarnessError, Plot

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


def trace(program, device, scene, rays, way, arguments, table):
    accel, builder, variant = way
    chosen = ["--variant", variant] if variant else []
    ptexp(program, ["trace", "--quiet", "--mesh", scene, "--rays", rays, "--accel", accel,
                    "--builder", builder, *chosen, "--device", device.choice, "--repeat",
                    str(arguments.repeat), "--warmup", str(arguments.warmup), "--csv", table],
          arguments.timeout)


def measure(program, device, arguments, folder):
    """A row for every set of rays and way to trace it."""
    scenes = [(scene, "") for scene in arguments.scenes] + BUILT_IN
    size = arguments.size
    if arguments.quick:
        scenes, size = [("terrain:2K", TERRAIN_CAMERA), ("statue:2K", "")], 32
    table = Path(folder, "rows.csv")
    for scene, camera in scenes:
        for kind in KINDS + (PATHS if scene.endswith((".xml", ".gltf", ".glb")) else []):
            rays = f"{name_of(scene)}.{kind}.rays".replace(":", "")
            path = str(Path(folder, rays))
            ptexp(program, ["rays", "--scene", scene, "--kind", kind, "--size", str(size),
                            *camera.split(), "--output", path], arguments.timeout)
            for way in CUDA if device.kind == "cuda" else CPU:
                trace(program, device, scene, path, way, arguments, str(table))
            os.unlink(path)
            print(f"{scene}: {kind}", flush=True)
    with open(table, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for row in rows:  # not where it was measured
        row["ray_file"] = Path(row["ray_file"]).name
        row["mesh"] = "/".join(p for p in Path(row["mesh"]).parts[-2:] if p != "..")
        row["command"] = row["command"].replace(str(folder) + "/", "").replace(str(table), "rows.csv")
    return [{"experiment": EXPERIMENT.name, "status": "measured", **row} for row in rows]


def run(arguments):
    program = harness.find_program(arguments.ptexp)
    device = harness.find_device(program, arguments.device)
    target = arguments.output / harness.device_folder(device)
    target.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="ptexp-") as folder:
        rows = measure(program, device, arguments, folder)
    path = target / f"{EXPERIMENT.name}{'-' if arguments.label else ''}{arguments.label}.csv"
    facts = {"experiment": EXPERIMENT.name, "question": EXPERIMENT.question,
             "command": shlex.join(["python3", *sys.argv]),
             "date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
             "program": harness.output_of(program, "--version").splitlines(),
             "gpus": harness.output_of("nvidia-smi", "--query-gpu=name,driver_version,"
                                       "clocks.max.sm", "--format=csv").splitlines(),
             "host": {"cpu": harness.cpu_model(), "cores": os.cpu_count()}}
    harness.write_atomically(path.with_suffix(".json"), json.dumps(facts, indent=2) + "\n")
    harness.write_atomically(path, harness.csv_text(rows))
    for row in rows:
        print(f"{row['ray_file']:40} {row['accel']:6} {row['builder']:6} {row['variant']:10} "
              f"{float(row['mrays_per_s']):10.1f} Mrays/s")
    print(f"\nwrote {path}")


EXPERIMENT = Experiment("ray_sets", __doc__.splitlines()[0], None, Plot("bars", "Ray sets"),
                        add_arguments=add_arguments)


def main():
    try:
        run(harness.parse_arguments(EXPERIMENT, None))
    except (HarnessError, OSError) as error:
        print(f"{EXPERIMENT.name}: error: {error}; no result was written", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
