#!/usr/bin/env python3
"""Image size: how does the time grow with the pixels, and which execution is fastest?

The paper's first measurement: 600x300, 1200x600 and 2400x1200 pixels at 100 samples, depth 50, for
the serial program, the parallel CPU and the GPU. The paper gives the mean of three runs of each
program: `image_ms_mean_of_3` is that of the first repeats of three rounds, a process each.
"""
import sys
from statistics import mean

from lib import harness
from lib.harness import Configuration, Experiment, Plot
from lib.intervals import in_rounds

SIZES = [(600, 300), (1200, 600), (2400, 1200)]
SPP = 100
TIMES = [f"image_ms_{part}" for part in ("median", "min", "max", "low", "high")]
PAPERS, PAPERS_RUNS = "image_ms_mean_of_3", 3
CPU_SERIES = {"serial, CPU": "serial", "megakernel, CPU": "megakernel",
              "wavefront, CPU": "wavefront"}
CUDA_SERIES = {"megakernel, CUDA": "megakernel", "wavefront, CUDA": "wavefront"}


def add_arguments(parser):
    parser.add_argument("--cpu-repeat", metavar="N", type=int, default=1,
                        help="as --repeat, for the slow rows on the CPU [%(default)s]")
    parser.add_argument("--cpu-warmup", metavar="N", type=int, default=0,
                        help="as --warmup, for the rows on the CPU [%(default)s]")
    parser.add_argument("--cpu-spp", metavar="N", type=int, default=0,
                        help="samples of the rows on the CPU; their times are then extrapolated "
                        "linearly and marked 'yes' in the column extrapolated [all samples]")


def image_of(arguments):
    """(sizes, samples per pixel)"""
    if arguments.quick:
        return [(width // 10, height // 10) for width, height in SIZES], 8
    return SIZES, SPP


def configurations(arguments, device):
    sizes, spp = image_of(arguments)
    on_cpu = {"device": "cpu", "repeat": arguments.cpu_repeat, "warmup": arguments.cpu_warmup}
    runs = [(series, mode, arguments.cpu_spp or spp, on_cpu)
            for series, mode in CPU_SERIES.items()]
    if device.kind == "cuda":
        runs += [(series, mode, spp, {}) for series, mode in CUDA_SERIES.items()]
    return [Configuration(
        f"{series} {width}x{height}",
        f"--mode {mode} --width {width} --height {height} --spp {spp_used} --max-depth 50",
        {"series": series, "panel": "", "x": width * height, "full_spp": spp, "extrapolated": "",
         **dict.fromkeys([*TIMES, PAPERS], "")},
        # CPU and GPU round differently: their images are only close.
        same_image=f"spheres on the {where.get('device', device.kind)}", **where)
            for width, height in sizes for series, mode, spp_used, where in runs]


def finish(rows, _arguments):
    """The time of the whole image: kernel_ms, or extrapolated where fewer samples were taken."""
    for row in rows:
        factor = int(row["full_spp"]) / int(row["spp"])
        row["extrapolated"] = "no" if factor == 1 else "yes"
        row["series"] += "" if factor == 1 else ", extrapolated"
        for time in TIMES:
            row[time] = f"{factor * float(row[time.replace('image', 'kernel')]):.6f}"
        firsts = [times[0] for times in in_rounds(
            [float(time) for time in row["kernel_ms_runs"].split(";")], int(row["rounds"]))]
        if len(firsts) >= PAPERS_RUNS:
            row[PAPERS] = f"{factor * mean(firsts[:PAPERS_RUNS]):.6f}"


EXPERIMENT = Experiment(
    "image_size", __doc__.splitlines()[0], configurations,
    Plot("lines", f"Image size: spheres, {SPP} samples, depth 50", "pixels",
         "kernel time of the image [ms]", "image_ms"),
    add_arguments, finish, ("image_ms_median", PAPERS, "extrapolated"))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
