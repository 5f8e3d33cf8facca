"""What tables show, in the words of the report: two times differ only if intervals are apart."""
import sys

from lib.program import ROOT

sys.path.insert(0, str(ROOT / "scripts"))
# pylint: disable=wrong-import-position
from report_parts.tables import BASES, in_groups, interval, plot_title  # noqa: E402,F401
from report_parts.words import (change, exponent, listed, relation, short,  # noqa: E402,F401
                                show, with_interval)


def time_of(row, column="kernel_ms"):
    """The median of a time in ms with its interval."""
    return interval(row, column)


def against(base, row, name, column="kernel_ms"):
    """'2.00 times as fast as NAME', say: a row against `base`, which is called so."""
    before, after = time_of(base, column), time_of(row, column)
    ratio, how = after.middle / before.middle, relation(before, after)
    if how == "overlap":
        return f"no significant difference to {name} ({show(ratio)} times its time)"
    text = f"{show(1 / ratio)} times as fast" if ratio < 1 else f"{show(ratio)} times as slow"
    return f"{text} as {name}" + (", by times without a spread" if how == "unknown" else "")


def against_megakernel(name, by_mode):
    """['NAME, wavefront: 2.00 times as fast as the megakernel'], say; [] where a mode is missing."""
    if not {"megakernel", "wavefront"} <= set(by_mode):
        return []
    return [f"{name}, wavefront: "
            + against(by_mode["megakernel"], by_mode["wavefront"], "the megakernel")]


def fastest(rows):
    """(the row of the shortest time, the others that do not differ significantly from it)"""
    best = min(rows, key=lambda row: time_of(row).middle)
    return best, [row for row in rows if row is not best
                  and relation(time_of(best), time_of(row)) == "overlap"]


def best_of(rows, label):
    """'A' or 'A and B, without a significant difference'."""
    best, equal = fastest(rows)
    names = [str(row[label]) for row in (best, *equal)]
    return listed(names) + (", without a significant difference" if equal else "")


def growth(rows, label):
    """'1,000 times the spheres take 12.0 times as long (spheres^0.36)'; rows with numbers x."""
    points = sorted((float(row["x"]), time_of(row).middle) for row in rows)
    power = exponent(points)
    if power is None:
        return ""
    (first, least), (last, most) = points[0], points[-1]
    return (f"{show(last / first)} times the {label} take {show(most / least)} times as long "
            f"({label}^{power:.2f})")
