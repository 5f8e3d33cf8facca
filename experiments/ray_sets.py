#!/usr/bin/env python3
"""Ray sets: which structure, builder and way of tracing are fastest for which kind of rays?

Makes sets of rays by `ptexp rays` and traces them by `ptexp trace` (docs/design/tracing.md). Mesh or
scene files may be named by --scenes.
"""
import sys
from functools import partial
from pathlib import Path

from lib import harness
from lib.harness import Experiment
from lib.traced_sets import RaySet, add_arguments, run, trace_command

# What a built-in scene is looked at from; files have cameras of their own.
TERRAIN_CAMERA = "--look-from -490,175,490 --look-at 0,10,0 --vfov 38"
BUILT_IN = [("terrain:10M", TERRAIN_CAMERA), ("statue:1M", "")]
KINDS = ["primary", "ao", "diffuse"]
PATHS = ["bounce:0", "bounce:1", "bounce:3"]  # of scene files, which have materials
CPU = [("bvh2", "sah", ""), ("cwbvh", "sah", ""), ("cwbvh", "sbvh", "")]
CUDA = [("bvh2", "sah", "threads"), ("cwbvh", "sah", "threads"), ("cwbvh", "sah", "persistent"),
        ("cwbvh", "sah", "beam"), ("cwbvh", "sbvh", "auto"), ("cwbvh", "hploc", "auto"),
        ("cwbvh", "hploc-reinsert", "auto")]


def name_of(scene):
    """modern-hall for .../modern-hall/scene.xml, bunny_room for .../bunny_room.mesh."""
    path = Path(scene).resolve()
    return path.parent.name if path.stem == "scene" else path.stem


def ray_sets(device, arguments, folder):
    """The files lie in `folder`."""
    scenes = [(scene, "") for scene in arguments.scenes] + BUILT_IN
    size = arguments.size
    if arguments.quick:
        scenes, size = [("terrain:2K", TERRAIN_CAMERA), ("statue:2K", "")], 32
    for scene, camera in scenes:
        for kind in KINDS + (PATHS if scene.endswith((".xml", ".gltf", ".glb")) else []):
            rays = str(Path(folder, f"{name_of(scene)}.{kind}.rays".replace(":", "")))
            make = ["rays", "--scene", scene, "--kind", kind, "--size", str(size),
                    *camera.split(), "--output", rays]
            traces = [trace_command(scene, rays, *way, device, arguments)
                      for way in (CUDA if device.kind == "cuda" else CPU)]
            yield RaySet(rays, make, traces)


EXPERIMENT = Experiment("ray_sets", __doc__.splitlines()[0], None, None,
                        add_arguments=add_arguments)

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT, runner=partial(run, sets_of=ray_sets)))
