"""Promises that rows keep or miss: a rate, by the best of several ways to render a scene; what a
process takes beyond its kernels."""


def verdict_of(holds, arguments):
    return "quick" if arguments.quick else "pass" if holds else "MISS"


def judge_best(rows, arguments):
    """Fills in `verdict` of the fastest row of each panel that has a `target_msamples_per_s`. An
    experiment's `finish`."""
    for scene in {row["panel"] for row in rows if row["target_msamples_per_s"]}:
        measured = [row for row in rows if row["panel"] == scene]
        best = max(measured, key=lambda row: float(row["mpaths_per_s"]))
        holds = float(best["mpaths_per_s"]) >= float(best["target_msamples_per_s"])
        best["verdict"] = verdict_of(holds, arguments)


def judge_overheads(rows, wall, empty_ms, arguments):
    """Fills in `over_ms`, the wall time of each process (column `wall`) without its kernels and
    without `empty_ms`, an empty program's, and `verdict` where there is a `goal_ms`."""
    for row in rows:
        if empty_ms is None or not row.get("kernel_ms_median"):
            continue
        over_ms = float(row[wall]) - float(row["kernel_ms_median"]) - empty_ms
        row["over_ms"] = f"{over_ms:.6f}"
        if row["goal_ms"]:
            row["verdict"] = verdict_of(over_ms <= float(row["goal_ms"]), arguments)
