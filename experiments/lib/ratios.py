"""Columns that say how many times as fast a row is as another one that renders the same."""
from lib.description import HarnessError

# A ratio is lowest if the base is as fast and the row as slow as they may be: wider than need be.
OPPOSITES = [("median", "median"), ("min", "max"), ("max", "min"), ("low", "high"), ("high", "low")]


def ratio_labels():
    """The columns ratio_*, empty until set_ratios."""
    return {f"ratio_{part}": "" for part, _ in OPPOSITES}


def set_ratios(rows, base_variant, scene_of):
    """The base's time by the row's, for the rows whose scene has a base. Both must have traced the
    same rays, else HarnessError."""
    bases = {scene_of(row): row for row in rows if row["variant"] == base_variant}
    for row in rows:
        base = bases.get(scene_of(row))
        if base is None:
            continue
        for column in ("paths", "rays", "shadow_rays"):
            if row[column] != base[column]:
                raise HarnessError(f"{row['name']} has {row[column]} {column}, {base['name']} has "
                                   f"{base[column]}; expected equal numbers")
        for part, opposite in OPPOSITES:
            ratio = float(base[f"kernel_ms_{part}"]) / float(row[f"kernel_ms_{opposite}"])
            row[f"ratio_{part}"] = f"{ratio:.4f}"
