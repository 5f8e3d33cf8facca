#!/usr/bin/env python3
"""Depth: what do more bounces cost, and how many paths are still alive?

The most rays of a path (--max-depth) in an open scene, whose paths soon leave it, and in a closed
room, where all of them go on. `alive` is the share of the paths that trace ray 1, 2, 3, ...
"""
import sys

from lib import harness
from lib.harness import Configuration, Experiment, Plot
from lib.sentences import against_megakernel, in_groups, show, time_of

DEPTHS, QUICK_DEPTHS = [1, 2, 4, 8, 16, 50], [1, 4]
MODES = ["megakernel", "wavefront"]
SCENES = {"spheres": "--scene spheres --width 1200 --height 600 --spp 50",
          "dial:16:0:closed": "--scene dial:16:0:closed --width 512 --height 512 --spp 16"}
QUICK_IMAGE = "--width 24 --height 12 --spp 2"
SHOWN = 8  # rays of the sentence on paths alive


def configurations(arguments, _device):
    rows = []
    for scene, image in SCENES.items():
        image = f"--scene {scene} {QUICK_IMAGE}" if arguments.quick else image
        rows += [Configuration(
            f"{scene}: {mode}, depth {depth}", f"--mode {mode} {image} --max-depth {depth}",
            {"panel": scene, "series": mode, "x": depth, "alive": "", "rays_per_path": ""},
            same_image=f"{scene}, depth {depth}")
                 for depth in (QUICK_DEPTHS if arguments.quick else DEPTHS) for mode in MODES]
    return rows


def finish(rows, _arguments):
    for row in rows:
        live = list(map(int, row["live_paths"].split(";")))
        row["alive"] = ";".join(f"{count / live[0]:.4g}" for count in live)
        row["rays_per_path"] = f"{int(row['rays']) / int(row['paths']):.4g}"


def conclude(rows, _arguments):
    lines = []
    for scene, mine in in_groups(rows, "panel").items():
        deepest = max(mine, key=lambda row: int(row["max_depth"]))
        shares = deepest["alive"].split(";")
        lines.append(f"{scene}: a path has {deepest['rays_per_path']} rays of at most "
                     f"{deepest['max_depth']}; of 100 paths "
                     + ", ".join(show(100 * float(share)) for share in shares[1:SHOWN])
                     + f" trace a ray 2, 3, ..., and {show(100 * float(shares[-1]))} ray "
                     f"{len(shares)}")
        for mode, of_mode in in_groups(mine, "series").items():
            ordered = sorted(of_mode, key=lambda row: int(row["max_depth"]))
            lines.append(f"{scene}, {mode}: " + ", ".join(
                f"{show(time_of(row).middle / int(row['rays']) * 1e6)} ns a ray at depth "
                f"{row['max_depth']}" for row in ordered))
        for depth, pair in in_groups(mine, "x").items():
            lines += against_megakernel(f"{scene}, depth {depth}",
                                        {row["series"]: row for row in pair})
    return lines


EXPERIMENT = Experiment(
    "depth", __doc__.splitlines()[0], configurations,
    Plot("lines", "Depth: the time over the most rays of a path", "rays at most"),
    finish=finish, conclude=conclude, table=("rays_per_path",))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
