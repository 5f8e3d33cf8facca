#!/usr/bin/env python3
"""Counters: what do the kernels do with the hardware?

Renders a few scenes with `ptexp --counters`, by the megakernel and by the wavefront with each way to
shade, to gather paths and to lay them out. A row is a kernel of one of them, or all together: SIMT
efficiency, issue, occupancy, hit rates, bytes, and for the wavefront's stages what their records
need (docs/experiments.md, "Hardware counters"). A configuration that cannot be counted is a row that
says why. Needs a GPU that may be profiled.
"""
import json
import sys
import tempfile
from functools import partial
from pathlib import Path

from lib import harness
from lib import program as ptexp
from lib.grouped import measure_table
from lib.harness import Configuration, Experiment, HarnessError
from lib.options import add_image_options
from lib.provenance import scene_hash

SCENES = ["cornell", "dial:8:0:closed", "dial:8:1:closed", "statue:1M"]
VARIANTS = {
    "megakernel": "--mode megakernel",
    "uber": "--mode wavefront --stages split --order-surfaces off",
    "uber, sorted": "--mode wavefront --stages split --order-surfaces on",
    "cub": "--mode wavefront --stages split --order-surfaces off --compaction cub",
    "no queues": "--mode wavefront --stages split --order-surfaces off --compaction none",
    "aos": "--mode wavefront --stages split --order-surfaces off --layout aos",
    "soa": "--mode wavefront --stages split --order-surfaces off --layout soa",
}
DEPTH = 8
ALL = "all kernels"


def add_arguments(parser):
    parser.set_defaults(repeat=3, rounds=1, warmup=1)
    add_image_options(parser)


def configurations(arguments, _device):
    size, spp = (24, 1) if arguments.quick else (arguments.size, arguments.spp)
    scenes = [scene.replace("1M", "1K") for scene in SCENES] if arguments.quick else SCENES
    return [Configuration(f"{scene}: {variant}",
                          f"--scene {scene} --width {size} --height {size} --spp {spp} "
                          f"--max-depth {DEPTH} --counters {options}",
                          {"scene": scene, "variant": variant})
            for scene in scenes for variant, options in VARIANTS.items()]


def command_of(program, device, configuration, arguments, folder):
    command = ptexp.command_line(program, configuration, device, arguments.repeat,
                                 arguments.warmup)
    return [str(Path(folder, word)) if word in ("image.ppm", "row.csv", "run.json") else word
            for word in command]


def count(command, stats, timeout_s):
    """(status, message, what --stats has)."""
    try:
        ptexp.run_ptexp(*command, timeout_s=timeout_s)
    except HarnessError as error:
        return "refused" if isinstance(error, harness.Refused) else "failed", str(error), {}
    facts = json.loads(Path(stats).read_text(encoding="utf-8"))
    problem = facts["counters"]["problem"]
    return ("failed", problem, {}) if problem else ("measured", "", facts)


def number(value):
    return "" if value is None else f"{value:.6g}"


def rows_of(configuration, status, message, facts):
    """A row for each kernel, and one for all together."""
    common = {"experiment": EXPERIMENT.name, "name": configuration.name, "status": status,
              "message": message, **configuration.labels,
              "scene_hash": scene_hash(configuration.arguments)}
    if status != "measured":
        return [common]
    counters = facts["counters"]
    kernels = [{"kernel": ALL, "launches": sum(k["launches"] for k in counters["kernels"]),
                **counters["total"]}, *counters["kernels"]]
    for kernel in kernels:
        moved = kernel["l2_read_bytes"] + kernel["l2_written_bytes"]
        predicted = kernel["predicted_read_bytes"] + kernel["predicted_written_bytes"]
        kernel["l2_bytes_per_ray"] = moved / max(counters["rays"], 1)
        kernel["predicted_bytes_per_ray"] = predicted / max(counters["rays"], 1)
    # Not `time_ms`, which in other tables is a time that was not counted.
    return [{**common, "render_ms": number(facts["time_ms"]["kernel"]["median"]),
             "rays": counters["rays"], "kernel": kernel["kernel"], "launches": kernel["launches"],
             "counted_ms": number(kernel["time_ms"]),
             **{name: number(value) for name, value in kernel.items()
                if name not in ("kernel", "launches", "time_ms")}} for kernel in kernels]


def text_of(row):
    """The row of all kernels as a line."""
    if row["status"] != "measured":
        return f"{row['name']:32} {row['status']}: {row['message']}"
    percent = {name: f"{100 * float(row[name] or 'nan'):5.1f} %"
               for name in ("issue", "occupancy", "l1_hit_rate", "l2_hit_rate")}
    return (f"{row['name']:32} {float(row['threads_per_instruction']):5.1f} threads, issue "
            f"{percent['issue']}, occupancy {percent['occupancy']}, L1 {percent['l1_hit_rate']}, "
            f"L2 {percent['l2_hit_rate']}, {float(row['l2_bytes_per_ray']):6.0f} B per ray "
            f"({float(row['predicted_bytes_per_ray']):.0f} predicted)")


def measure(program, device, configuration, arguments):
    """The rows of one configuration."""
    with tempfile.TemporaryDirectory(prefix="ptexp-") as folder:
        command = command_of(program, device, configuration, arguments, folder)
        rows = rows_of(configuration, *count(command, Path(folder, "run.json"), arguments.timeout))
    print(text_of(rows[0]), flush=True)
    return rows


def run(experiment, arguments):
    program, device = harness.program_and_device(arguments)
    chosen = configurations(arguments, device)
    commands = {c.name: command_of(program, device, c, arguments, ".")[1:] for c in chosen}
    if arguments.list:
        return harness.list_commands(program, commands.values())
    harness.check_gpu(experiment, device)
    path, rows = measure_table(
        experiment, arguments, program, device, kind="counted",
        parts=[commands, *(scene_hash(c.arguments) for c in chosen)],
        groups=((c.name, partial(measure, program, device, c, arguments)) for c in chosen))
    print(f"\ntable: {path}")
    return int(any(row["status"] == "failed" for row in rows or ()))


EXPERIMENT = Experiment("counters", __doc__.splitlines()[0], configurations, None,
                        add_arguments=add_arguments, needs_gpu=True)

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT, runner=run))
