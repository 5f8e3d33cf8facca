#!/usr/bin/env python3
"""Sampling: what is each way to sample worth, at equal samples and at equal time?

Every row differs from the defaults by what its name says; all converge to one image. The error is
relMSE against a reference of 64 times the samples and another seed. `error_x_time` is the error
times the kernel time, relative to the defaults: below 1 is better at equal time, since the error of
independent samples falls as the time grows. Scene files may be named behind --scenes.
"""
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

import harness
from harness import Configuration, Experiment, HarnessError, Plot

BUILT_IN = ["cornell", "boxes"]
DEFAULTS = "defaults"
WAYS = {
    "sampling uniform, nee off": "--sampling uniform --nee off",
    "sampling cosine, nee off": "--sampling cosine --nee off",
    "sampling bsdf, nee off": "--nee off",
    "sampling uniform": "--sampling uniform",
    "sampling cosine": "--sampling cosine",
    "mis none": "--mis none",
    "mis balance": "--mis balance",
    DEFAULTS: "",
    "light-selection uniform": "--light-selection uniform",
    "light-selection power": "--light-selection power",
    "light-selection tree": "--light-selection tree",
    "rr 3": "--rr 3",
    "sampler stratified": "--sampler stratified",
    "sampler sobol": "--sampler sobol",
    "sampler sobol, light-selection tree": "--sampler sobol --light-selection tree",
}
BEST = "--sampler sobol"
REFERENCE_SEED = 1000003
DEPTH = 8


def add_arguments(parser):
    parser.add_argument("--scenes", nargs="*", default=[], metavar="FILE",
                        help="scene files to measure besides the built-in scenes")
    parser.add_argument("--size", type=int, default=256, metavar="N",
                        help="width and height in pixels [%(default)s]")
    parser.add_argument("--spp", type=int, default=64, metavar="N",
                        help="samples per pixel, a power of two [%(default)s]")


def scenes_of(arguments):
    return {"/".join(Path(scene).parts[-2:]): scene for scene in
            BUILT_IN + [str(Path(path).resolve()) for path in arguments.scenes]}


def image_of(scene, arguments):
    size, spp = (16, 4) if arguments.quick else (arguments.size, arguments.spp)
    return f"--scene {scene} --width {size} --height {size} --max-depth {DEPTH}", spp


def configurations(arguments, _device):
    rows = []
    for name, scene in scenes_of(arguments).items():
        image, spp = image_of(scene, arguments)
        for way, options in WAYS.items():
            rows.append(Configuration(f"{name}: {way}", f"{image} --spp {spp} {options}",
                                      {"panel": name, "x": way, "relmse": "", "error_x_time": ""}))
    return rows


def run_ptexp(program, *arguments):
    run = subprocess.run([program, *arguments], capture_output=True, text=True, check=False)
    if run.returncode > 1:  # compare: 1 is a difference
        raise HarnessError(f"{shlex.join(map(str, arguments))}: {run.stderr.strip()}")
    return run.stdout


def relmse(program, image, reference):
    return float(re.search(r"(?m)^relMSE\s+(\S+)$",
                           run_ptexp(program, "compare", image, reference)).group(1))


def finish(rows, arguments):
    program = harness.find_program(arguments.ptexp)
    device = harness.find_device(program, arguments.device).choice
    for name, scene in scenes_of(arguments).items():
        image, spp = image_of(scene, arguments)
        with tempfile.TemporaryDirectory(prefix="ptexp-") as folder:
            def render(options, file):
                path = Path(folder, file)
                run_ptexp(program, *shlex.split(f"{image} {options}"), "--device", device,
                          "--quiet", "--output", str(path))
                return path
            reference = render(f"--spp {64 * spp} --seed {REFERENCE_SEED} {BEST}", "reference.exr")
            mine = [row for row in rows if row["panel"] == name]
            for row in mine:
                picture = render(f"--spp {spp} {WAYS[row['x']]}", "image.exr")
                row["relmse"] = relmse(program, picture, reference)
        by_way = {row["x"]: row["relmse"] * float(row["kernel_ms_median"]) for row in mine}
        for row in mine:
            row["error_x_time"] = f"{by_way[row['x']] / by_way[DEFAULTS]:.3f}"
            row["relmse"] = f"{row['relmse']:.6g}"


EXPERIMENT = Experiment(
    "sampling", __doc__.splitlines()[0], configurations,
    Plot("bars", "Time of each way to sample at equal samples", log_y=False),
    add_arguments=add_arguments, finish=finish, table=("relmse", "error_x_time"))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
