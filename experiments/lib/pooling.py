"""Makes one row of the processes that measured a configuration, one in each round."""
import re
from statistics import mean, median

from lib.intervals import median_interval

ONCE = ["scene_ms", "setup_ms", "load_ms", "transfer_ms", "image_write_ms", "build_ms"]
PART = re.compile(r"process_(?!total)(\w+)_ms")  # of the process's wall time, as ptexp divides it


def number(value):
    return f"{value:.6f}"


def stage_times(runs, stage, named):
    """A stage's time in each run. `other` is the sum of the stages without columns."""
    if stage == "other":
        return [sum(ms for name, ms in run["stages"].items() if name not in named) for run in runs]
    return [run["stages"].get(stage) for run in runs]


def put_times(row, column, times):
    row.update({f"{column}_median": number(median(times)), f"{column}_min": number(min(times)),
                f"{column}_max": number(max(times))})


def put_rounds(row, column, rounds):
    """The interval of the median, and all times: `rounds` are tuples of times."""
    low, high = median_interval(rounds)
    row.update({f"{column}_low": number(low), f"{column}_high": number(high),
                f"{column}_runs": ";".join(number(time) for times in rounds for time in times)})


def put_interval(row, column, processes):
    """The times of the runs, as the harness gives those of kernel_ms."""
    put_rounds(row, column, tuple(tuple(run[column] for run in process.runs)
                                  for process in processes))


def parts_of(process):
    """{part: ms} of the wall time of a process, which is their sum. ptexp's `render` is divided into
    the kernels and the rest; `end` is what the process takes after its statistics are written."""
    row, parts = process.row, {}
    for part in filter(None, map(PART.fullmatch, row)):
        name, ms = part[1], float(row[part[0]])
        if name == "render":
            parts["kernels"] = sum(run["kernel_ms"] for run in process.runs)
            name, ms = "render_rest", ms - parts["kernels"]
        parts[name] = ms - (process.early_ms if name == "start" else 0)
    if not parts:
        return {"undivided": process.wall_ms}
    return {**parts, "end": process.wall_ms - sum(parts.values())}


def put_process(row, processes):
    """The wall time of whole processes and its parts: medians, of which each is of its own process,
    and their intervals."""
    divided = [{"wall": process.wall_ms, **parts_of(process)} for process in processes]
    for part in divided[0]:
        column, times = f"process_{part}_ms", [parts[part] for parts in divided]
        row[column] = number(median(times))
        put_rounds(row, column, tuple((time,) for time in times))
        if part != "wall":
            del row[f"{column}_runs"]


def put_devices(row, runs):
    """Of several devices: units of the last run, and by how much the device that had the most to do
    exceeds the mean of all."""
    row["units"] = str(sum(device["units"] for device in runs[-1]["devices"]))
    times = [[device["kernel_ms"] for device in run["devices"]] for run in runs]
    put_times(row, "uneven_ms", [max(of_run) - mean(of_run) for of_run in times])


def pooled(processes, whole_process=False):
    """ptexp's row as if one process had rendered all repeats, with the columns of the harness.
    What is no time is the last process's."""
    row = dict(processes[-1].row)
    runs = [run for process in processes for run in process.runs]
    own = {"rounds": str(len(processes))}
    if not runs:  # not ptexp's render
        put_process(own, processes)
        return {**own, "repeat": own["rounds"]}
    times = [run["kernel_ms"] for run in runs]
    put_times(row, "kernel_ms", times)
    stages = [column.removesuffix("_ms_median") for column in row
              if re.fullmatch(r"(?!kernel_)\w+_ms_median", column)]
    for stage in stages:
        of_stage = stage_times(runs, stage, stages)
        if row[f"{stage}_ms_median"] and None not in of_stage:
            put_times(row, f"{stage}_ms", of_stage)
    for column in row:
        if row[column] and (column in ONCE or column.startswith("process_")):
            row[column] = number(median(float(process.row[column]) for process in processes))
    rates = {"mpaths_per_s": ["paths"], "mrays_per_s": ["rays", "shadow_rays"]}
    for column, counts in rates.items():
        if row.get(column):
            count = sum(int(row[name]) for name in counts)
            row[column] = f"{count / (1000 * median(times)):.6g}"
    put_interval(own, "kernel_ms", processes)
    if all(run.get("wall_ms") for run in runs):
        put_times(row, "wall_ms", [run["wall_ms"] for run in runs])
        put_interval(own, "wall_ms", processes)
    if all(run.get("devices") for run in runs):
        put_devices(own, runs)
    row["repeat"] = str(len(times))
    if whole_process:
        put_process(own, processes)
    return {**own, **row, **own}
