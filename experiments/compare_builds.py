#!/usr/bin/env python3
"""Compare builds: has a commit made anything slower?

Measures two programs, A before and B after the change, taking turns, over a short list of
configurations or over those of another experiment, and gives for each the ratio of the medians
B / A with its 95 % interval. Exit code 1: B is slower by more than 2 % in some row, and the whole
interval says so.

`--one-process` compares two ways to measure a program instead: A is a process for each configuration
and round, B is one process (`ptexp measure`). Exit code 1: a row differs by more than 1 %, and the
whole interval says so.
"""
import importlib
import math
import shlex
import sys
from dataclasses import replace
from statistics import median

from lib import harness
from lib.harness import Configuration, Experiment
from lib.image_check import with_options
from lib.intervals import bootstrap
from lib.ratios import runs_of
from lib.resident import EACH, ONE, needs_own_process

BUILDS = ["A", "B"]
SLOWER = 1.02  # an interval wholly above it is a loss
EQUAL = 1.01  # of two ways to measure
SCENES = {"spheres": "--scene spheres --width 1200 --height 600 --spp 50 --max-depth 50",
          "cornell": "--scene cornell --width 1024 --height 1024 --spp 32 --max-depth 8",
          "statue:100K": "--scene statue:100K --width 1024 --height 1024 --spp 16 --max-depth 8",
          "dial:16:0:closed": "--scene dial:16:0:closed --width 512 --height 512 --spp 8 "
                              "--max-depth 8"}
# From 0.1 ms on; for each mode the plain one and what changes kernels, pool or launches.
WAYS_SCENES = {**SCENES, "cornell, one sample": "--scene cornell --width 128 --height 128 --spp 1 "
                                                "--max-depth 8"}
WAYS_MODES = ["--mode megakernel", "--mode megakernel --work pixel", "--mode wavefront",
              "--mode wavefront --schedule host", "--mode wavefront --pool-size 64K",
              "--mode wavefront --compaction scan"]
QUICK = "--width 24 --height 12 --spp 2"


def add_arguments(parser):
    parser.set_defaults(repeat=20, rounds=5)
    parser.add_argument("a", metavar="A", help="the program before the change")
    parser.add_argument("b", metavar="B", nargs="?", default="", help="the program after it")
    parser.add_argument("--one-process", action="store_true",
                        help="A in a process for each configuration, and A in one process")
    parser.add_argument("--experiment", metavar="NAME", default="",
                        help="measure the configurations of this experiment with its defaults "
                        "[a short list]")
    parser.add_argument("--other-images", action="store_true",
                        help="the change may change images: do not compare them")


def cases(arguments, device):
    """Configurations of one build."""
    if arguments.experiment:
        experiment = importlib.import_module(arguments.experiment).EXPERIMENT
        own = harness.parse_arguments(experiment, ["--quick"] if arguments.quick else [])
        own.ptexp, own.list = arguments.a, True  # without folders for images
        return experiment.configurations(own, device)
    small = QUICK if arguments.quick else ""
    scenes, modes = ((WAYS_SCENES, WAYS_MODES) if arguments.one_process else
                     (SCENES, ["--mode megakernel", "--mode wavefront"]))
    return [Configuration(f"{scene}: {mode.removeprefix('--mode ')}",
                          shlex.join([*with_options(options, small), *mode.split()]))
            for scene, options in scenes.items() for mode in modes]


def configurations(arguments, device):
    programs = {"A": arguments.a, "B": arguments.b}
    ways = {"A": EACH, "B": ONE}

    def own(build):
        if arguments.one_process:
            return {"way": ways[build]}
        return {"program": str(harness.find_program(programs[build]))}
    return [replace(case, name=f"{case.name} ({build})", **own(build), image="",
                    same_image="" if arguments.other_images or arguments.one_process else case.name,
                    labels={"panel": "", "series": build, "x": "", "build": build,
                            "case": case.name,
                            **{f"ratio_{part}": "" for part in ("median", "low", "high")},
                            "verdict": ""})
            for case in cases(arguments, device) if case.renders
            and not (arguments.one_process and needs_own_process(case)) for build in BUILDS]


def flat(rounds):
    return [time for of_round in rounds for time in of_round]


def ratio(samples):
    """Of medians, B by A."""
    return median(samples[1]) / median(samples[0])


def mean_ratio(samples):
    """The geometric mean of the ratios of pairs A, B."""
    logs = [math.log(ratio(samples[i:i + 2])) for i in range(0, len(samples), 2)]
    return math.exp(sum(logs) / len(logs))


def pairs_of(rows):
    """(row of A, row of B) of the cases that both have measured."""
    by_case = {}
    for row in rows:
        by_case.setdefault(row["case"], {})[row["build"]] = row
    return [(rows["A"], rows["B"]) for rows in by_case.values() if len(rows) == 2]


def verdict_of(low, high, is_way=False):
    if is_way:
        is_apart, is_within = low > EQUAL or high < 1 / EQUAL, low >= 1 / EQUAL and high <= EQUAL
        return "DIFFERENT" if is_apart else "equal" if is_within else "ambiguous"
    if low > SLOWER:
        return "SLOWER"
    return "slower" if low > 1 else "faster" if high < 1 else "no significant difference"


def finish(rows, arguments):
    for before, after in pairs_of(rows):
        samples = [runs_of(before), runs_of(after)]
        low, high = bootstrap(samples, ratio)
        after.update(ratio_median=f"{ratio(list(map(flat, samples))):.4f}",
                     ratio_low=f"{low:.4f}", ratio_high=f"{high:.4f}",
                     verdict=verdict_of(low, high, arguments.one_process))


def conclude(rows, arguments):
    pairs = pairs_of(rows)
    if not pairs:
        return ["no configuration was measured with both programs"]
    samples = [runs_of(row) for pair in pairs for row in pair]
    mean = mean_ratio(list(map(flat, samples)))
    low, high = bootstrap(samples, mean_ratio)
    if arguments.one_process:
        found = {word: [after["case"] for _, after in pairs if after["verdict"] == word]
                 for word in ("equal", "ambiguous", "DIFFERENT")}
        return [f"times in one process are {mean:.4f} times those of single processes (geometric "
                f"mean of {len(pairs)}; {low:.4f} to {high:.4f}): "
                f"{verdict_of(low, high, is_way=True)} within 1 %",
                f"equal within 1 %: {len(found['equal'])} of {len(pairs)}; ambiguous: "
                f"{', '.join(found['ambiguous']) or 'none'}",
                f"different by more than 1 %: {', '.join(found['DIFFERENT']) or 'none'}"]
    slower = [after["case"] for _, after in pairs if after["verdict"] == "SLOWER"]
    return [f"B takes {mean:.4f} times as long as A (geometric mean of "
            f"{len(pairs)}; {low:.4f} to {high:.4f}): {verdict_of(low, high)}",
            f"slower by more than 2 %: {', '.join(slower) or 'none'}"]


def run(experiment, arguments):
    if bool(arguments.b) == arguments.one_process:
        raise harness.HarnessError("expected two programs, or one and --one-process")
    arguments.ptexp = arguments.b = arguments.b or arguments.a
    code = harness.run(experiment, arguments)
    if code or arguments.list:
        return code
    path = harness.table_path(experiment, harness.find_device(arguments.b, arguments.device),
                              arguments)
    return int(any(row["verdict"] in ("SLOWER", "DIFFERENT") for row in harness.read_rows(path)))


EXPERIMENT = Experiment(
    "compare_builds", __doc__.splitlines()[0], configurations, None, add_arguments=add_arguments,
    finish=finish, conclude=conclude,
    table=("ratio_median", "ratio_low", "ratio_high", "verdict"))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT, runner=run))
