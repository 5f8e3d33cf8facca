#!/usr/bin/env python3
"""Sampling: what is each way to sample worth, at equal samples and at equal time?

Every row differs from the defaults by what its name says; all converge to one image. Each way
renders with 4 and with 64 samples and then for a second (--time-limit). The error is relMSE against
a reference that the best way renders for 20 seconds with another seed. `gain` is the error of what
was the default before, divided by the row's: at equal samples, or at equal time, where errors are
taken to fall as 1 / time for the little that a render ends before or after the second.
"""
import shlex
import sys
import tempfile
from pathlib import Path

from lib import harness
from lib.errors import KeptImages
from lib.harness import Configuration, Experiment, Plot, Refused
from lib.scene_files import short_name

BUILT_IN = ["cornell"]
SHARED = harness.ROOT.parent / "shared" / "scenes"
UNIFORM = "sampling uniform, nee off"
BEFORE = "before: power, independent"
BEST = "best: light tree, Sobol"
WAYS = {
    UNIFORM: "--sampling uniform --nee off",
    "sampling cosine, nee off": "--sampling cosine --nee off",
    "nee off": "--nee off",
    "sampling uniform": "--sampling uniform",
    "sampling cosine": "--sampling cosine",
    "mis none": "--mis none",
    "mis balance": "--mis balance",
    BEFORE: "--light-selection power --sampler independent",
    "light-selection uniform": "--light-selection uniform",
    "light-selection tree": "--light-selection tree",
    "rr 3": "--rr 3",
    "sampler stratified": "--sampler stratified",
    "sampler sobol": "--sampler sobol",
    BEST: "--light-selection tree --sampler sobol",
    "best, rr 3": "--light-selection tree --sampler sobol --rr 3",
}
LEAST_GAIN = {UNIFORM: 20, BEFORE: 2}  # of the best way at equal time, in the scenes
DEPTH = 8


def add_arguments(parser):
    parser.set_defaults(repeat=3, warmup=1)
    parser.add_argument("--scenes", nargs="*", metavar="DIR|FILE",
                        help="scene files to measure besides the Cornell box; of a folder those in "
                        "its folders [the repository's ../shared/scenes; none with --quick]")
    parser.add_argument("--size", type=int, default=256, metavar="N",
                        help="width and height in pixels [%(default)s]")
    parser.add_argument("--samples", type=int, nargs="+", default=[4, 64], metavar="N",
                        help="samples per pixel of the rows at equal samples [4 64]")
    parser.add_argument("--seconds", type=float, default=1.0, metavar="S",
                        help="of the rows at equal time [%(default)s]")
    parser.add_argument("--reference-seconds", type=float, default=20.0, metavar="S",
                        help="of each scene's reference [%(default)s]")
    parser.add_argument("--mode", default="wavefront", help="ptexp's mode [%(default)s]")


def settle(arguments):
    """What --quick makes of the arguments."""
    if arguments.quick:
        arguments.size, arguments.samples = 12, [1, 4]
        arguments.seconds, arguments.reference_seconds = 0.01, 0.05


def scene_files(arguments):
    """Those that --scenes names; where it does not, and there is no folder beside the repository,
    it says that they are left out."""
    named = arguments.scenes
    if named is None:
        if not arguments.quick and not SHARED.is_dir():
            print(f"no scene files: there is no {SHARED}")
        named = [str(SHARED)] if not arguments.quick and SHARED.is_dir() else []
    files = []
    for path in map(Path, named):
        files += sorted(path.glob("*/*.xml")) if path.is_dir() else [path]
    return [str(path.resolve()) for path in files]


def scenes_of(arguments):
    return {short_name(scene): scene
            for scene in BUILT_IN + scene_files(arguments)}


def image_of(scene, arguments):
    return (f"--scene {shlex.quote(scene)} --width {arguments.size} --height {arguments.size} "
            f"--max-depth {DEPTH} --mode {arguments.mode}")


def chooses_lights(program, scene):
    """Whether --light-selection applies: not to scenes of spheres and quads."""
    with tempfile.TemporaryDirectory(prefix="ptexp-") as folder:
        try:
            harness.run_ptexp(program, "--scene", scene, "--width", "1", "--height", "1", "--spp",
                              "1", "--light-selection", "power", "--device", "cpu", "--quiet",
                              "--output", str(Path(folder, "probe.ppm")))
        except Refused as refusal:
            if "--light-selection" not in str(refusal).partition("ptexp: error: ")[2]:
                raise
            return False
    return True


def ways_of(program, scene):
    """{way: options}. Where lights are not chosen, what was the default before still is."""
    if chooses_lights(program, scene):
        return WAYS
    ways = {way: options for way, options in WAYS.items()
            if not way.startswith("light-selection")}
    return {**ways, BEFORE: ""}


def configurations(arguments, _device):
    settle(arguments)
    program = harness.find_program(arguments.ptexp)
    images = arguments.images = KeptImages("sampling", arguments)
    rows = []
    for name, scene in scenes_of(arguments).items():
        image = image_of(scene, arguments)
        for way, options in ways_of(program, scene).items():
            def add(equal, amount, limit, **more):
                full_name = f"{name}: {way}, {amount}"
                rows.append(Configuration(
                    full_name, f"{image} {options} {limit}",
                    {"panel": name, "series": way, "x": "", "equal": equal, "relmse": "",
                     "gain": ""}, image=images.add(full_name), **more))
            for spp in arguments.samples:
                add(f"{spp} spp", f"{spp} spp", f"--spp {spp}")
            add("time", f"{arguments.seconds:g} s", f"--time-limit {arguments.seconds:g}",
                repeat=1, warmup=0)
    return rows


def finish(rows, arguments):
    program, device = harness.program_and_device(arguments)
    for name, scene in scenes_of(arguments).items():
        mine = [row for row in rows if row["panel"] == name]
        arguments.images.put_errors(mine, program, device.choice, f"{image_of(scene, arguments)} "
                                    f"{WAYS[BEST]}", arguments.reference_seconds)
        for row in mine:
            row["x"] = row["kernel_ms_median"]
        fill_in_gains(mine, arguments.seconds)
    arguments.images.remove()


def error_of(row, seconds):
    """At equal time: what it would be after just this time."""
    error = float(row["relmse"])
    is_timed = row["equal"] == "time"
    return error * float(row["kernel_ms_median"]) / (1000 * seconds) if is_timed else error


def fill_in_gains(rows, seconds):
    """Of one scene."""
    before = {row["equal"]: error_of(row, seconds) for row in rows if row["series"] == BEFORE}
    for row in rows:
        error = error_of(row, seconds)
        if error > 0 and row["equal"] in before:
            row["gain"] = f"{before[row['equal']] / error:.3g}"


def conclude(rows, arguments):
    """For each scene a table with a line for each way, and whether the best one is worth what the
    issue asks for."""
    lines = []
    for name in dict.fromkeys(row["panel"] for row in rows):
        mine = [row for row in rows if row["panel"] == name]
        amounts = list(dict.fromkeys(row["equal"] for row in mine))
        titles = [f"{arguments.seconds:g} s" if a == "time" else a for a in amounts]
        lines.append(f"{name}: relMSE (gain over what was the default before)")
        lines.append("".join([" " * 28, *(f"{title:>22}" for title in titles)]))
        for way in dict.fromkeys(row["series"] for row in mine):
            cells = {row["equal"]: f"{float(row['relmse']):.3g} ({row['gain']})" for row in mine
                     if row["series"] == way}
            lines.append("".join([f"{way:28}", *(f"{cells.get(a, ''):>22}" for a in amounts)]))
        lines += [*verdicts(mine, arguments), ""]
    return lines


def verdicts(rows, arguments):
    errors = {row["series"]: error_of(row, arguments.seconds) for row in rows
              if row["equal"] == "time"}
    best = errors.get(BEST, 0)
    for way, least in LEAST_GAIN.items():
        if best > 0 and way in errors:
            gain = errors[way] / best
            verdict = "quick" if arguments.quick else "pass" if gain >= least else "MISS"
            yield (f"{BEST}: {gain:.3g} times less error after {arguments.seconds:g} s than {way}, "
                   f"expected {least}: {verdict}")


EXPERIMENT = Experiment(
    "sampling", __doc__.splitlines()[0], configurations,
    Plot("lines", "Error of each way to sample: 4 and 64 samples per pixel, and after a second",
         "kernel time [ms]", "relMSE", y="relmse"),
    add_arguments=add_arguments, finish=finish, conclude=conclude, table=("relmse", "gain"))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
