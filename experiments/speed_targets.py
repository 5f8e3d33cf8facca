#!/usr/bin/env python3
"""Speed targets: are the times that the project promises on one H200 reached?

Each row has its target beside the measured value. Further columns check that the time grows
linearly with pixels x samples and that the wavefront's waves do not grow with samples x depth.
"""
import sys

from lib import harness
from lib.harness import Configuration, Experiment, Plot

MODES = ["megakernel", "wavefront"]

# (scene, width, height, samples): the target of each mode. A time in ms, a rate in 10^9 paths/s.
TARGETS = {
    ("spheres", 600, 300, 50): {"megakernel": "<= 1.2 ms", "wavefront": "<= 2.0 ms"},
    ("spheres", 2400, 1200, 100): {"megakernel": ">= 9 Gpaths/s", "wavefront": ">= 5 Gpaths/s"},
    ("rtow", 1200, 600, 100): dict.fromkeys(MODES, "<= 45 ms, one mode"),
}

# More images of `spheres`; the growth of time is judged from one to the next, samples then pixels.
GROWTH = [(600, 300, 25), (600, 300, 50), (600, 300, 100), (600, 300, 200)]
GROWTH_PIXELS = [(600, 300, 100), (1200, 600, 100), (2400, 1200, 100)]
DEPTHS = [5, 200]  # besides 50, at 600x300 and 50 samples
# A GPU that is not full yet may well need less than twice the time for twice the paths.
GROWTH_MAX = 1.1
# The pool is full but at the end; 1.1 allows for slots that wait a wave for their new path.
WAVES_MAX = 1.1

VERDICTS = ["verdict", "growth_verdict", "waves_verdict"]


def target_ms(target, paths):
    """The target as a time, for the plot; nothing where there is none."""
    if not target:
        return ""
    value = float(target.split()[1])
    return f"{paths / value * 1e-6 if 'paths' in target else value:.6g}"


def configurations(arguments, _device):
    images = [(*target, 50) for target in TARGETS]
    images += [("spheres", *image, 50) for image in GROWTH + GROWTH_PIXELS]
    images += [("spheres", 600, 300, 50, depth) for depth in DEPTHS]
    return [configuration(mode, *image, arguments.quick)
            for image in dict.fromkeys(images) for mode in MODES]


def configuration(mode, scene, width, height, spp, depth, quick):
    targets = TARGETS.get((scene, width, height, spp), {}) if depth == 50 else {}
    if quick:
        width, height, spp = width // 20, height // 20, spp // 10
    paths = width * height * spp
    target = targets.get(mode, "")
    return Configuration(
        f"{mode}, {scene} {width}x{height}, {spp} samples, depth {depth}",
        f"--mode {mode} --scene {scene} --width {width} --height {height} --spp {spp} "
        f"--max-depth {depth}",
        {"series": f"{mode}, {scene}", "panel": "", "x": paths if depth == 50 else "",
         "target": target, "target_ms": target_ms(target, paths), "reached": "", "growth": "",
         "waves_expected": "", **dict.fromkeys(VERDICTS, "")},
        same_image=f"{scene}, depth {depth}")


def verdict(holds):
    return "pass" if holds else "MISS"


def judge_targets(rows):
    for row in rows:
        if not row["target"]:
            continue
        kernel_ms = float(row["kernel_ms_median"])
        row["reached"] = (f"{float(row['mpaths_per_s']) / 1e3:.3g} Gpaths/s"
                          if "paths" in row["target"] else f"{kernel_ms:.3g} ms")
        row["verdict"] = verdict(kernel_ms <= float(row["target_ms"]))
    shared = [row for row in rows if row["target"].endswith("one mode")]
    if any(row["verdict"] == "pass" for row in shared):
        for row in shared:
            row["verdict"] = "pass" if row["verdict"] == "pass" else "-"


def judge_growth(rows):
    """t(b) / t(a) against paths(b) / paths(a), for neighbours a, b of a series of images."""
    def image(row):
        return int(row["width"]) * int(row["height"]), int(row["spp"])
    measured = [row for row in rows if row["scene"] == "spheres" and row["max_depth"] == "50"]
    for mode in MODES:
        series = sorted((row for row in measured if row["mode"] == mode), key=lambda row: row["x"])
        for row in series:
            before = [other for other in series if other["x"] < row["x"] and
                      (image(other)[0] == image(row)[0]) != (image(other)[1] == image(row)[1])]
            if not before:
                continue
            paths = row["x"] / before[-1]["x"]
            time = float(row["kernel_ms_median"]) / float(before[-1]["kernel_ms_median"])
            row["growth"] = f"paths x{paths:.3g}, time x{time:.3g}"
            row["growth_verdict"] = verdict(time <= GROWTH_MAX * paths)


def judge_waves(rows):
    """A full pool traces one ray per slot and wave; the last paths take at most max_depth waves."""
    for row in rows:
        if row["waves"] == "0":
            continue
        pool, rays = int(row["used_pool_size"]), int(row["rays"])
        expected = WAVES_MAX * rays / pool + int(row["max_depth"])
        row["waves_expected"] = f"<= {expected:.0f}"
        row["waves_verdict"] = verdict(int(row["waves"]) <= expected)


def finish(rows, arguments):
    judge_targets(rows)
    judge_growth(rows)
    judge_waves(rows)
    if arguments.quick:  # the targets are for the full images
        for row in rows:
            row.update({column: "quick" for column in VERDICTS if row[column]})


EXPERIMENT = Experiment(
    "speed_targets", __doc__.splitlines()[0], configurations,
    Plot("lines", "Speed targets: time against pixels x samples, depth 50", "paths"),
    finish=finish, table=("target", "reached", "verdict", "growth", "growth_verdict", "waves",
                          "waves_expected", "waves_verdict"))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
