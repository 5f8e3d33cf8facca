#!/usr/bin/env python3
"""Ray order: what is it worth to sort rays before they are traced?

The third segments of paths, traced in four orders: as the paths of neighbouring pixels come,
shuffled, by the Morton number of their origins, and by the octant of their directions and then by
origin. The host sorts; its time does not count, so a gain is what a sort on the device may cost at
most.
"""
import sys
from functools import partial
from pathlib import Path

from lib import harness
from lib.harness import Experiment, Plot
from ray_sets import TERRAIN_CAMERA, name_of
from lib.sentences import change, in_groups, interval, show
from lib.traced_sets import RaySet, add_arguments, run, trace_command

AS_MADE = "as made"
ORDERS = {AS_MADE: "", "shuffled": "shuffled", "by origin": "origin",
          "by direction and origin": "direction"}
BUILT_IN = [("statue:1M", ""), ("terrain:10M", TERRAIN_CAMERA)]
CPU = [("bvh2", "sah", ""), ("cwbvh", "sah", "")]
CUDA = [("bvh2", "hploc", "threads"), ("cwbvh", "hploc", "persistent")]


def add_options(parser):
    add_arguments(parser)
    parser.set_defaults(size=1024)  # Python sorts a million rays in a few seconds


def ray_sets(device, arguments, folder):
    """The files lie in `folder`."""
    scenes = [(scene, "") for scene in arguments.scenes] + BUILT_IN
    size = arguments.size
    if arguments.quick:
        scenes, size = [("statue:2K", "")], 32
    for scene, camera in scenes:
        for label, order in ORDERS.items():
            name = f"{name_of(scene)}.diffuse-{order or 'made'}".replace(":", "")
            rays = str(Path(folder, f"{name}.rays"))
            make = ["rays", "--scene", scene, "--kind", "diffuse", "--size", str(size),
                    *camera.split(), "--output", rays]
            traces = [trace_command(scene, rays, *way, device, arguments)
                      for way in (CUDA if device.kind == "cuda" else CPU)]
            yield RaySet(rays, make, traces, order, {"panel": "", "x": label})


def finish(rows, _arguments):
    for row in rows:
        scene = row["ray_file"].partition(".")[0]
        row["panel"] = f"{scene}, {row['accel']}, {row['variant']}"


def conclude(rows, _arguments):
    """What an order saves, and what that leaves for the sorting of a ray."""
    lines = []
    for panel, mine in in_groups(rows, "panel").items():
        base = next((row for row in mine if row["x"] == AS_MADE), None)
        for row in mine:
            if base is None or row is base:
                continue
            before, after = interval(base, "time_ms"), interval(row, "time_ms")
            word, ratio = change(before, after)
            text = f"{panel}, {row['x']}: {show(ratio)} times the time as made ({word})"
            if word == "faster":
                saved_ns = (before.middle - after.middle) * 1e6 / int(row["rays"])
                text += f"; it pays if sorting takes less than {show(saved_ns)} ns a ray"
            lines.append(text)
    return lines


EXPERIMENT = Experiment(
    "ray_order", __doc__.splitlines()[0], None,
    Plot("bars", "Diffuse rays in four orders", y_label="time of the rays [ms]", y="time_ms",
         log_y=False),
    add_arguments=add_options, finish=finish, conclude=conclude)

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT, runner=partial(run, sets_of=ray_sets)))
