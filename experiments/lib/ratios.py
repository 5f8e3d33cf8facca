"""Columns that say how many times as fast a row is as another one that renders the same."""
from lib.description import HarnessError
from lib.intervals import in_rounds, interval_of_ratio

# A ratio is lowest if the base is as fast and the row as slow as they may be: wider than need be.
OPPOSITES = [("median", "median"), ("min", "max"), ("max", "min"), ("low", "high"), ("high", "low")]
# Of rays, in rows whose hits are others': more would be another scene or a fault.
MOST_OTHER_RAYS = 0.01


def ratio_labels():
    """The columns ratio_*, empty until set_ratios."""
    return {f"ratio_{part}": "" for part, _ in OPPOSITES}


def rays_of(row):
    return int(row["rays"]) + int(row["shadow_rays"] or 0)


def check_rays(row, base, has_other_hits):
    """Both must have traced the same rays, or nearly so where hits are others'; else HarnessError."""
    for column in ("paths", "rays", "shadow_rays"):
        if row[column] == base[column]:
            continue
        found, expected = int(row[column] or 0), int(base[column] or 0)
        if not has_other_hits or column == "paths":
            wanted = "equal numbers"
        elif abs(found - expected) > MOST_OTHER_RAYS * expected:
            wanted = f"numbers within {MOST_OTHER_RAYS:.0%}"
        else:
            continue
        raise HarnessError(f"{row['name']} has {row[column]} {column}, {base['name']} has "
                           f"{base[column]}; expected {wanted}")


def set_ratios(rows, base_variant, scene_of, has_other_hits=lambda row: False):
    """The base's time by the row's, for the rows whose scene has a base. Both must have traced the
    same rays (check_rays); the ratio is that of times per ray where has_other_hits(row)."""
    bases = {scene_of(row): row for row in rows if row["variant"] == base_variant}
    for row in rows:
        base = bases.get(scene_of(row))
        if base is None:
            continue
        check_rays(row, base, has_other_hits(row))
        more = rays_of(row) / rays_of(base) if rays_of(base) > 0 else 1
        for part, opposite in OPPOSITES:
            ratio = more * float(base[f"kernel_ms_{part}"]) / float(row[f"kernel_ms_{opposite}"])
            row[f"ratio_{part}"] = f"{ratio:.4f}"


def ns_per_ray(row, part="median"):
    """A row's time by its rays and shadow rays, in ns."""
    return f"{1e6 * float(row[f'kernel_ms_{part}']) / rays_of(row):.4g}"


def runs_of(row):
    """The times of a row's repeats, a list for each round; None where the table does not keep them."""
    if not row.get("kernel_ms_runs") or not row.get("rounds"):
        return None
    return in_rounds([float(time) for time in row["kernel_ms_runs"].split(";")], int(row["rounds"]))


def ratio_interval(top, bottom):
    """(low, high) of the ratio of two rows' kernel times by bootstrap; None where the runs of one
    are not kept, were one alone, or were made in other rounds than those of the other."""
    samples = [runs_of(row) for row in (top, bottom)]
    if None in samples or len(samples[0]) != len(samples[1]) or any(
            sum(map(len, sample)) < 2 for sample in samples):
        return None
    return interval_of_ratio(*(tuple(map(tuple, sample)) for sample in samples))
