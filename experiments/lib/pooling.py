"""Makes one row of the processes that measured a configuration, one in each round."""
import re
from statistics import median

from lib.intervals import median_interval

ONCE = ["scene_ms", "setup_ms", "load_ms", "transfer_ms", "image_write_ms", "build_ms"]


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


def pooled(processes):
    """ptexp's row as if one process had rendered all repeats, with the columns of the harness.
    What is no time is the last process's."""
    row = dict(processes[-1].row)
    runs = [run for process in processes for run in process.runs]
    times = [run["kernel_ms"] for run in runs]
    put_times(row, "kernel_ms", times)
    stages = [column.removesuffix("_ms_median") for column in row
              if re.fullmatch(r"(?!kernel_)\w+_ms_median", column)]
    for stage in stages:
        of_stage = stage_times(runs, stage, stages)
        if row[f"{stage}_ms_median"] and None not in of_stage:
            put_times(row, f"{stage}_ms", of_stage)
    for column in ONCE:
        if row.get(column):
            row[column] = number(median(float(process.row[column]) for process in processes))
    rates = {"mpaths_per_s": ["paths"], "mrays_per_s": ["rays", "shadow_rays"]}
    for column, counts in rates.items():
        if row.get(column):
            count = sum(int(row[name]) for name in counts)
            row[column] = f"{count / (1000 * median(times)):.6g}"
    low, high = median_interval(tuple(tuple(run["kernel_ms"] for run in process.runs)
                                      for process in processes))
    row["repeat"] = str(len(times))
    return {"rounds": str(len(processes)), "kernel_ms_low": number(low),
            "kernel_ms_high": number(high), "kernel_ms_runs": ";".join(map(number, times)), **row}
