#!/usr/bin/env python3
"""Ray sets: which structure, builder and way of tracing are fastest for which kind of rays?

Makes sets of rays by `ptexp rays` and traces them by `ptexp trace` (docs/tracing.md). Mesh or scene
files may be named by --scenes.
"""
import hashlib
import json
import shlex
import sys
import tempfile
from pathlib import Path

import harness
from harness import Experiment, HarnessError
from journal import Journal
from program import failure_of, version_of

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


def without_folder(row, folder):
    """Not where it was measured."""
    row["ray_file"] = Path(row["ray_file"]).name
    row["mesh"] = "/".join(p for p in Path(row["mesh"]).parts[-2:] if p != "..")
    row["command"] = row["command"].replace(f"{folder}/", "")
    return row


def option(command, name):
    return command[command.index(name) + 1] if name in command else ""


def measure(program, rays, make, traces, arguments):
    """A row for every way to trace one set of rays."""
    folder, rows = Path(rays).parent, []
    no_rays = failure_of(program, make, arguments.timeout)
    for trace in traces:
        table = Path(folder, "rows.csv")
        message = no_rays or failure_of(program, trace, arguments.timeout)
        row = {"experiment": EXPERIMENT.name, "status": "failed" if message else "measured",
               "message": message or ""}
        if message:
            ways = {name: option(trace, f"--{name}") for name in ("accel", "builder", "variant")}
            row.update(ways, ray_file=Path(rays).name, mesh=option(trace, "--mesh"))
        else:
            row.update(without_folder(harness.read_rows(table)[0], folder))
            table.unlink()
        rows.append(row)
    Path(rays).unlink(missing_ok=True)
    return rows


def key_of(program, device, arguments):
    """Equal for calls whose measurements may stand in one table."""
    sets = [[make, *traces] for _, make, traces in ray_sets(device, arguments, ".")]
    facts = json.dumps([version_of(program), device.name, sets])
    return hashlib.sha256(facts.encode()).hexdigest()[:16]


def measured_sets(journal):
    """{ray file: rows} of the sets that need not be measured again."""
    return {event["name"]: event["rows"] for event in journal.of("ray set")
            if all(row["status"] == "measured" for row in event["rows"])}


def measure_all(program, device, arguments, journal, save):
    """All rows; `save` is called with those so far after every set of rays."""
    known, rows = measured_sets(journal), []
    with tempfile.TemporaryDirectory(prefix="ptexp-") as folder:
        for rays, make, traces in ray_sets(device, arguments, folder):
            name = Path(rays).name
            if name not in known:
                known[name] = measure(program, rays, make, traces, arguments)
                journal.add("ray set", name=name, rows=known[name])
                print(name, flush=True)
            rows += known[name]
            save(rows)
    return rows


def run(experiment, arguments):
    program = harness.find_program(arguments.ptexp)
    device = harness.find_device(program, arguments.device)
    if arguments.list:
        for _, make, traces in ray_sets(device, arguments, "."):
            for command in [make, *traces]:
                print(shlex.join([str(program), *command]))
        return 0
    path = harness.table_path(experiment, device, arguments)
    journal = Journal(path.with_suffix(".journal"), key_of(program, device, arguments),
                      arguments.fresh, lambda _: True)
    journal.begin(date=harness.now())
    facts = harness.provenance(experiment, program, device, arguments)

    def save(rows, complete=False):
        if any(row["status"] == "measured" for row in rows):
            harness.write_table(path, rows, {**facts, "complete": complete})
    rows = measure_all(program, device, arguments, journal, save)
    failed = [row for row in rows if row["status"] == "failed"]
    if len(failed) == len(rows):
        journal.remove()
        raise HarnessError(f"nothing was measured: {rows[0]['message']}; no result was written")
    save(rows, complete=not failed)
    for row in rows:
        result = (f"failed: {row['message']}" if row["status"] == "failed" else
                  f"{float(row['mrays_per_s']):10.1f} Mrays/s")
        way = f"{row['accel']:6} {row['builder']:6} {row['variant']:10}"
        print(f"{row['ray_file']:40} {way} {result}")
    print(f"\nwrote {path}")
    if not failed:
        journal.remove()
    return 1 if failed else 0


EXPERIMENT = Experiment("ray_sets", __doc__.splitlines()[0], None, None,
                        add_arguments=add_arguments)

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT, runner=run))
