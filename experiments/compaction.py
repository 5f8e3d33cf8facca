#!/usr/bin/env python3
"""Compaction: how much of a copy's bandwidth does each strategy reach, over items and density?

Measured by `ptexp compact` (docs/statistics.md), without a renderer around it.
"""
import shlex
import sys
import tempfile
from functools import partial
from pathlib import Path

from lib import harness
from lib.grouped import measure_table, measured_of
from lib.harness import Experiment, Plot
from lib.program import failure_of

ITEMS = ["64K", "1M", "4M", "16M", "64M"]
CPU_ITEMS = ["64K", "1M", "4M", "16M"]
DENSITIES = ["0.1", "0.5", "0.9"]
# How the waiting slots lie, and whether a cache may hold the memory.
WAYS = {"random, cold": "--run 1 --cache cold", "random, warm": "--run 1 --cache warm",
        "in runs of 256, cold": "--run 256 --cache cold"}
TARGET = 0.8  # of a copy's bandwidth
TARGET_ITEMS = 1 << 24
SHORT_ITEMS = 1 << 22  # below, the time counts and not the bandwidth


def processes(device, arguments):
    """{name: command of ptexp but for the table}, in the order of measuring."""
    items = ITEMS if device.kind == "cuda" else CPU_ITEMS
    densities, ways = DENSITIES, WAYS
    if arguments.quick:
        items, densities, ways = ["1K", "16K"], ["0.5"], {"random, warm": WAYS["random, warm"]}
    return {f"{count}, {way}": ["compact", "--quiet", "--items", count, "--density",
                                ",".join(densities), *options.split(), "--device", device.choice,
                                "--repeat", str(arguments.repeat),
                                "--warmup", str(arguments.warmup)]
            for way, options in ways.items() for count in items}


def labelled(row, way):
    """The row of `ptexp compact` with its place in the table and in the plot."""
    queues = "1 queue" if row["queues"] == "1" else f"{row['queues']} queues"
    return {"experiment": EXPERIMENT.name,
            "name": f"{row['strategy']}, {queues}, {row['items']} items, {row['density']}, {way}",
            "status": "measured", "message": "", "series": f"{row['strategy']}, {queues}",
            "panel": f"density {row['density']}, {way}", "x": row["items"], **row}


def measure(program, name, command, arguments):
    """The rows of one process."""
    way = name.partition(", ")[2]
    with tempfile.TemporaryDirectory(prefix="ptexp-") as folder:
        table = Path(folder, "rows.csv")
        message = failure_of(program, [*command, "--csv", str(table)], arguments.timeout)
        if message:
            return [{"experiment": EXPERIMENT.name, "name": name, "status": "failed",
                     "message": message}]
        rows = harness.read_rows(table)
    for row in rows:
        row["command"] = shlex.join(command)
    return [labelled(row, way) for row in rows]


def conclude(rows):
    """Sentences about the target and about short passes."""
    sentences = []
    cold = [row for row in rows if row["cache"] == "cold" and row["strategy"] != "none"]
    for series in dict.fromkeys(row["series"] for row in cold):
        mine = [row for row in cold if row["series"] == series]
        large = [float(row["copy_share"]) for row in mine if int(row["items"]) >= TARGET_ITEMS]
        if large:
            verdict = "reached" if min(large) >= TARGET else "MISS"
            sentences.append(f"{series}: {100 * min(large):.0f} to {100 * max(large):.0f} % of a "
                             f"copy's bandwidth from 16 M items on (target {100 * TARGET:.0f} %: "
                             f"{verdict})")
        short = [1e3 * float(row["time_ms"]) for row in mine if int(row["items"]) < SHORT_ITEMS]
        if short:
            sentences.append(f"{series}: {min(short):.1f} to {max(short):.1f} us below 4 M items")
    return sentences


def run(experiment, arguments):
    program, device = harness.program_and_device(arguments)
    commands = processes(device, arguments)
    if arguments.list:
        return harness.list_commands(program, commands.values())
    path, rows = measure_table(
        experiment, arguments, program, device, kind="items", parts=commands,
        groups=((name, partial(measure, program, name, command, arguments))
                for name, command in commands.items()))
    if rows is None:
        print(f"table: {path}")
        return 0
    measured = measured_of(rows)
    for row in measured:
        print(f"{row['name']:60} {1e3 * float(row['time_ms']):10.2f} us "
              f"{float(row['gb_per_s']):8.1f} GB/s, {float(row['copy_share']):5.3f} of a copy")
    for row in rows:
        if row["status"] == "failed":
            print(f"{experiment.name}: failed: {row['name']}: {row['message']}", file=sys.stderr)
    print("\n".join(["", *conclude(measured), f"table: {path}", harness.draw(path)]))
    return 0 if len(measured) == len(rows) else 1


EXPERIMENT = Experiment(
    "compaction", __doc__.splitlines()[0], None,
    Plot("lines", "Compaction of tags", "items", "part of a copy's bandwidth", y="copy_share",
         log_y=False, mark=TARGET),
    conclude=lambda rows, _arguments: conclude(rows))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT, runner=run))
