"""A promised rate, which the best of several ways to render a scene keeps or misses."""


def judge_best(rows, arguments):
    """Fills in `verdict` of the fastest row of each panel that has a `target_msamples_per_s`. An
    experiment's `finish`."""
    for scene in {row["panel"] for row in rows if row["target_msamples_per_s"]}:
        measured = [row for row in rows if row["panel"] == scene]
        best = max(measured, key=lambda row: float(row["mpaths_per_s"]))
        holds = float(best["mpaths_per_s"]) >= float(best["target_msamples_per_s"])
        best["verdict"] = "quick" if arguments.quick else "pass" if holds else "MISS"
