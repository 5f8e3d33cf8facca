#!/usr/bin/env python3
"""Scaling: how efficient are several devices, ranks and machines, and where is time lost?

Strong scaling renders one image by more and more devices, weak scaling gives each of them the same
number of samples. The efficiency is that of wall times against one device's. `uneven_ms` is how much
longer the device with the most to do was busy than the mean; `outside_ms` what the wall time has
beyond that device: units that were not there, films that came home. `predicted` is the efficiency
that the simulation of --simulate expects of as many equal devices for an image that takes one of
them as long. Scene, set-up and transfer come once for all renders and have columns of their own.

--units measures, on one device, what dividing an image costs. --simulate asks how larger clusters
would do, by lib/simulated_clusters.py.
"""
import os
import shlex
import sys
from statistics import median

from lib import harness, simulated_clusters
from lib.harness import Configuration, Experiment, HarnessError, Plot
from lib.intervals import bootstrap, in_rounds
from lib.sentences import in_groups, show

IMAGE = "--scene dial:16:0:closed --width 1024 --height 1024 --max-depth 8 --mode wavefront"
QUICK_IMAGE = "--scene cornell --width 24 --height 12 --max-depth 8 --mode wavefront"
UNITS = [1, 2, 4, 8, 16, 32, 64]
EFFICIENCY = [f"efficiency_{part}" for part in ("median", "low", "high")]


def numbers(text):
    found = [int(part) for part in text.split(",") if part]
    if found and (min(found) < 1 or len(set(found)) < len(found)):
        raise ValueError
    return found


def add_arguments(parser):
    add = parser.add_argument
    add("--devices", metavar="N,...", type=numbers, default=None,
        help="devices of this machine [1, 2, 4, ... and all GPUs; of CPUs 1,2,4]")
    add("--ranks", metavar="N,...", type=numbers, default=[],
        help="processes, started by --launcher [none]")
    add("--launcher", metavar="TEXT", default="mpirun --bind-to none -n {ranks}",
        help="what starts them; in a job of Slurm: 'srun -n {ranks}' [%(default)s]")
    add("--image", metavar="TEXT", default="",
        help=f"ptexp's options of the image [{IMAGE}]")
    add("--spp", metavar="N", type=int, default=256, help="samples per pixel [%(default)s]")
    add("--threads", metavar="N", type=int, default=0,
        help="CPU threads of each device, where CPUs render [cores over the most devices]")
    add("--units", action="store_true",
        help="measure one device with images divided into 1 to 64 units (label: units)")
    simulated_clusters.add_arguments(parser)


def image_of(arguments):
    if arguments.quick:
        return QUICK_IMAGE, 4
    return arguments.image or IMAGE, arguments.spp


def device_counts(arguments, device):
    if arguments.devices is not None:
        return arguments.devices
    count = 4 if device.kind == "cpu" else device.gpus
    return sorted({2**i for i in range(count.bit_length())} | {count})


def threads_of(arguments, counts):
    return arguments.threads or max((os.cpu_count() or 1) // max([*counts, 1]), 1)


def labels(panel, series, x):
    return {"panel": panel, "series": series, "x": x, "outside_ms": "",
            **dict.fromkeys([*EFFICIENCY, "predicted"], "")}


def devices_text(kind, count):
    """As --device takes it."""
    if kind == "cpu":
        return f"cpu:{count}" if count > 1 else "cpu"
    return "cuda:" + ",".join(map(str, range(count)))


def launcher_of(arguments, device, count):
    """Of a GPU for each rank: all of them else, shared by fewer ranks."""
    text = arguments.launcher.format(ranks=count)
    if device.kind == "cuda" and count < device.gpus:
        return f"env CUDA_VISIBLE_DEVICES={','.join(map(str, range(count)))} {text}"
    return text


def of_units(arguments, device):
    image, spp = image_of(arguments)
    one = devices_text(device.kind, 1)
    whole = Configuration("not divided", f"{image} --spp {spp}", labels("units", "one device", ""),
                          device=one, same_image="image")
    return [whole] + [
        Configuration(f"units per device: {count}", f"{image} --spp {spp}",
                      labels("units", "one device", count), device=one, same_image="image",
                      launcher=f"env PTEXP_UNITS_PER_DEVICE={count}") for count in UNITS]


def configurations(arguments, device):
    if arguments.units:
        return of_units(arguments, device)
    image, spp = image_of(arguments)
    ways = [("devices", count) for count in device_counts(arguments, device)]
    ways += [("ranks", count) for count in arguments.ranks]
    threads = threads_of(arguments, [count for _, count in ways])
    rows = []
    for panel in ("strong", "weak"):
        for series, count in ways:
            samples = spp * count if panel == "weak" else spp
            options = f"{image} --spp {samples}"
            is_rank = series == "ranks"
            if device.kind == "cpu":
                options += f" --threads {threads * (1 if is_rank else count)}"
            rows.append(Configuration(
                f"{panel}: {count} {series}", options, labels(panel, series, count),
                # A rank takes the GPU of its place.
                device=("cpu" if device.kind == "cpu" else "auto") if is_rank
                else devices_text(device.kind, count), same_image="image",
                launcher=launcher_of(arguments, device, count) if is_rank else ""))
    return rows


def times_of(row):
    """Wall times, a list for each round."""
    return in_rounds([float(time) for time in row["wall_ms_runs"].split(";")], int(row["rounds"]))


def base_of(row, rows):
    """The row of one device: of the same series if it has one, else of the other one; of an image
    that is divided into units, the undivided one."""
    mine = [other for other in rows if other["panel"] == row["panel"]]
    if row["panel"] == "units":
        return next((other for other in mine if other["x"] == ""), None)
    ones = [other for other in mine if int(other["x"]) == 1]
    return next((one for one in ones if one["series"] == row["series"]), ones[0] if ones else None)


def prediction(row, base, arguments):
    one_s = 1e-3 * float(base["wall_ms_median"])
    if one_s <= 0:
        return ""
    size = int(row["width"]), int(row["height"])
    over_links = row["series"] == "ranks"
    return f"{simulated_clusters.predicted(int(row['x']), one_s, size, over_links, arguments):.4f}"


def finish(rows, arguments):
    for row in rows:
        kernel = float(row["kernel_ms_median"])
        row["outside_ms"] = f"{float(row['wall_ms_median']) - kernel:.6f}"
        base = base_of(row, rows)
        if base is None:
            continue
        more = int(row["x"]) if row["panel"] == "strong" else 1

        def efficiency(samples, more=more):
            return median(samples[0]) / (more * median(samples[1]))
        both = [times_of(base), times_of(row)]
        value = efficiency([sum(rounds, []) for rounds in both])
        ends = bootstrap(both, efficiency) if base is not row else (1, 1)
        row.update({name: f"{number:.4f}" for name, number in zip(EFFICIENCY, [value, *ends])})
        if row["panel"] == "strong" and base is not row:
            row["predicted"] = prediction(row, base, arguments)


def share(row, column, whole):
    return f"{100 * float(row[column]) / whole:.1f} %"


def conclude(rows, _arguments):
    lines = []
    for (panel, series), mine in in_groups(rows, "panel", "series").items():
        for row in mine:
            if not row["efficiency_median"] or row["x"] in ("", "1", 1):
                continue
            wall = float(row["wall_ms_median"])
            lost = [f"outside of the longest device's kernels {share(row, 'outside_ms', wall)}"]
            if row.get("uneven_ms_median"):
                lost.insert(0, f"uneven {share(row, 'uneven_ms_median', wall)}")
            lines.append(
                f"{panel}, {row['x']} {series}: efficiency {show(float(row['efficiency_median']))} "
                f"[{show(float(row['efficiency_low']))}, {show(float(row['efficiency_high']))}]"
                + (f" (simulated: {show(float(row['predicted']))})" if row["predicted"] else "")
                + "; "
                f"of the wall time {', '.join(lost)}")
    return lines


def run(experiment, arguments):
    if arguments.simulate:
        return simulated_clusters.run(experiment, arguments)
    if arguments.units and not arguments.label.endswith("units"):
        arguments.label = "-".join(filter(None, [arguments.label, "units"]))
    if not shlex.split(arguments.launcher) and arguments.ranks:
        raise HarnessError("--launcher: expected a command")
    return harness.run(experiment, arguments)


EXPERIMENT = Experiment(
    "scaling", __doc__.splitlines()[0], configurations,
    Plot("lines", "Efficiency against one device", "devices or ranks", "efficiency", "efficiency",
         log_y=False, mark=1),
    add_arguments, finish, ("efficiency_median", "predicted", "uneven_ms_median", "outside_ms"), conclude)

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT, runner=run))
