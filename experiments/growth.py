#!/usr/bin/env python3
"""Growth: how does the time grow with samples, pixels, spheres, triangles and lights?

Each mode traces the structure that suits it: a binary tree of spheres, of triangles a binary one in
the megakernel and a wide one in the wavefront, built by H-PLOC on a GPU. The lights are a ceiling
of lamps that this script makes (lamp_scene.py), chosen by power or through the tree of lights; one
builder for all of them, since H-PLOC's tree of 100,000 lamps costs 1.6 times as much as SAH's.
(`image_size` has the paper's sizes and the CPU, `dial` the growth with materials.)
"""
import shlex
import shutil
import sys

from lib import harness
from lib.harness import Configuration, Experiment, Plot
from lib.lamp_scene import write_lamp_scene
from lib.sentences import against, growth, in_groups

TREES = {"megakernel": "--accel bvh2", "wavefront": "--accel cwbvh"}
SPP = [1, 8, 64, 512]
SIZES = [(300, 150), (1200, 600), (4800, 2400)]
SPHERES = [50, 1000, 30_000, 1_000_000]
TRIANGLES = {"1K": 10**3, "100K": 10**5, "10M": 10**7, "100M": 10**8}
LIGHTS = [1, 100, 10_000, 100_000]
SELECTIONS = ["power", "tree"]
QUICK = "--width 24 --height 12 --spp 2"


def lamp_folder(arguments):
    return arguments.output.resolve() / ".growth-scenes"


def cases(arguments, device):
    """(panel, x, what is added to the series, options without a mode and a tree of triangles)"""
    def some(values):
        return list(values)[:2] if arguments.quick else values

    def image(size):
        return QUICK if arguments.quick else size
    small = 20 if arguments.quick else 1
    for spp in some(SPP):
        yield ("samples", spp, "",
               f"--width {600 // small} --height {300 // small} --spp {spp} --max-depth 50")
    for width, height in some(SIZES):
        width, height = width // small, height // small
        yield ("pixels", width * height, "",
               f"--width {width} --height {height} --spp 16 --max-depth 50")
    for count in some(SPHERES):
        yield ("spheres", count, "", f"--spheres {count} --accel bvh2 --max-depth 50 "
               + image("--width 600 --height 300 --spp 50"))
    builder = "--builder hploc" if device.kind == "cuda" else ""
    for name, count in some(TRIANGLES.items()):
        yield ("triangles", count, "", f"--scene terrain:{name} {builder} --max-depth 8 "
               + image("--width 1024 --height 1024 --spp 16"))
    for count in some(LIGHTS):
        path = lamp_folder(arguments) / f"lamps-{count}" / "scene.xml"
        if not arguments.list:
            write_lamp_scene(path, count)
        scene = shlex.quote(str(path))
        for selection in SELECTIONS:
            yield ("lights", count, f", by {selection}", f"--scene {scene} --builder sah "
                   f"--light-selection {selection} --max-depth 8 "
                   + image("--width 1024 --height 1024 --spp 16"))


def configurations(arguments, device):
    return [Configuration(
        f"{panel}, {x}: {mode}{more}",
        f"--mode {mode} {options}" + (f" {tree}" if "--scene" in options else ""),
        {"panel": panel, "series": f"{mode}{more}", "x": x}, same_image=f"{panel}, {x}{more}")
            for panel, x, more, options in cases(arguments, device)
            for mode, tree in TREES.items()]


def finish(_rows, arguments):
    shutil.rmtree(lamp_folder(arguments))


def conclude(rows, _arguments):
    lines = [f"{panel}, {series}: {text}"
             for (panel, series), mine in in_groups(rows, "panel", "series").items()
             for text in [growth(mine, panel)] if text]
    for panel, mine in in_groups(rows, "panel").items():
        most = max(mine, key=lambda row: float(row["x"]))["x"]
        last = {row["series"]: row for row in mine if row["x"] == most}
        for series, row in last.items():
            base = series.replace("wavefront", "megakernel")
            if base != series and base in last:
                lines.append(f"{panel}, {float(most):,.0f}, {series}: "
                             f"{against(last[base], row, 'the megakernel')}")
    return lines


EXPERIMENT = Experiment(
    "growth", __doc__.splitlines()[0], configurations,
    Plot("lines", "Growth: spheres (depth 50), terrain and lamps (depth 8)"),
    finish=finish, conclude=conclude, image_check="--width 256 --height 256 --spp 4")

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
