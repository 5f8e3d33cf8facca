#!/usr/bin/env python3
"""Random numbers: what do stored generator states cost, and what do Sobol points give?

Philox is a function of pixel, sample and dimension. XORWOW, as cuRAND has it and the paper uses it,
keeps a state for each path, which the stage render_init sets up. Sobol points come from the kernels
for all scenes, which need more than those for spheres and quads: so Philox is measured in both
(--kernel-set general). `relmse` is the error
against a reference that Sobol points render for --reference-seconds; `efficiency` is Philox's error
times its time, divided by the row's: above 1 the row needs less time for an error.
"""
import sys

from lib import harness
from lib.errors import KeptImages
from lib.harness import Configuration, Experiment, Plot
from lib.sentences import against, in_groups, show, time_of

MODES = ["megakernel", "wavefront"]
PHILOX, XORWOW = "Philox", "XORWOW"
GENERAL, SOBOL = "Philox, kernels for all scenes", "Sobol, kernels for all scenes"
GENERATORS = {PHILOX: "", XORWOW: "--rng xorwow", GENERAL: "--kernel-set general",
              SOBOL: "--sampler sobol"}
BASES = {XORWOW: PHILOX, SOBOL: GENERAL}  # what each is compared with
SCENES = {"spheres": "--scene spheres --width 600 --height 300 --max-depth 50",
          "cornell": "--scene cornell --width 512 --height 512 --max-depth 8"}
WITH_XORWOW = ["spheres"]  # as in the paper; CUDA has no kernels for lamps with it
QUICK = "--scene spheres --width 16 --height 16 --max-depth 8"
SPP = 64


def add_arguments(parser):
    parser.add_argument("--reference-seconds", type=float, default=8.0, metavar="S",
                        help="of each scene's reference [%(default)s]")


def scenes_of(arguments):
    return {"spheres": QUICK} if arguments.quick else SCENES


def configurations(arguments, _device):
    if arguments.quick:
        arguments.reference_seconds = 0.05
    images = arguments.images = KeptImages("random_numbers", arguments)
    rows = []
    for scene, image in scenes_of(arguments).items():
        for mode in MODES:
            for generator, options in GENERATORS.items():
                if generator == XORWOW and scene not in WITH_XORWOW:
                    continue
                name = f"{scene}, {mode}: {generator}"
                rows.append(Configuration(
                    name, f"--mode {mode} {image} --spp {4 if arguments.quick else SPP} {options}",
                    {"panel": f"{scene}, {mode}", "x": generator, "set_up_ms": "", "relmse": "",
                     "efficiency": ""}, image=images.add(name),
                    same_image=f"{scene}: {generator}"))
    return rows


def cost(row):
    """Errors fall as 1 / time, so that their product is what a generator is worth."""
    return float(row["relmse"]) * time_of(row).middle


def finish(rows, arguments):
    program, device = harness.program_and_device(arguments)
    for scene, image in scenes_of(arguments).items():
        arguments.images.put_errors(
            [row for row in rows if row["panel"].startswith(f"{scene},")], program, device.choice,
            f"--mode wavefront {image} --sampler sobol", arguments.reference_seconds)
    put_efficiency(rows)
    arguments.images.remove()


def put_efficiency(rows):
    for mine in in_groups(rows, "panel").values():
        base = next((row for row in mine if row["x"] == PHILOX), None)
        for row in mine:
            row["set_up_ms"] = row["render_init_ms_median"]
            if base and cost(row) > 0:
                row["efficiency"] = f"{cost(base) / cost(row):.3g}"


def conclude(rows, _arguments):
    lines = []
    for panel, mine in in_groups(rows, "panel").items():
        by_generator = {row["x"]: row for row in mine}
        for generator, base in BASES.items():
            row, other = by_generator.get(generator), by_generator.get(base)
            if not (row and other):
                continue
            set_up = (f"; setting up its states takes {float(row['set_up_ms']):.3g} ms of "
                      f"{time_of(row).middle:.3g}" if row["set_up_ms"] else "")
            more_mib = (int(row["memory_bytes"]) - int(other["memory_bytes"])) / 2**20
            error = float(other["relmse"]) / max(float(row["relmse"]), 1e-30)
            lines.append(f"{panel}, {generator}: {against(other, row, base)}{set_up}; "
                         f"{more_mib:+,.0f} MiB of memory; {show(error)} times less error at "
                         "equal samples (of one image each, without an interval)")
    return lines


EXPERIMENT = Experiment(
    "random_numbers", __doc__.splitlines()[0], configurations,
    Plot("bars", f"Random numbers: {SPP} samples per pixel", log_y=False),
    add_arguments=add_arguments, finish=finish, conclude=conclude,
    table=("set_up_ms", "memory_bytes", "relmse", "efficiency"))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
