"""Numbers and comparisons in words. Two values differ only if their intervals are apart."""
import math

from .shared import intervals

SAME, change, relation = intervals.SAME, intervals.change, intervals.relation


def show(value, digits=3):
    """So many significant digits, as a person writes them: 1.09, 29.5, 104,678."""
    if value == 0 or not math.isfinite(value):
        return f"{value:g}"
    places = digits - 1 - math.floor(math.log10(abs(value)))
    return f"{value:,.{min(max(places, 0), 9)}f}"


def plain(value):
    """A count as it is, 1,024; anything else with three digits."""
    return f"{value:,.0f}" if value == int(value) else show(value)


def short(value):
    """For axes: 4096, 180k, 2.88M."""
    if abs(value) < 1e4 and value == int(value) and abs(value) % 1000:
        return f"{value:.0f}"
    for limit, letter in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if abs(value) >= limit:
            return f"{value / limit:.3g}{letter}"
    return f"{value:.3g}"


def unit_of(column):
    return "ms" if column.endswith("_ms") else ""


def with_interval(value, unit="", digits=3):
    spread = value.known and value.low != value.high
    while spread and digits < 6 and show(value.low, digits) == show(value.high, digits):
        digits += 1  # the ends shall differ
    text = show(value.middle, digits) + (f" {unit}" if unit else "")
    if not value.known:
        return text
    return f"{text} [{show(value.low, digits)}, {show(value.high, digits)}]"


def quotient(a, b):
    """The interval of a / b that the extremes of both allow."""
    known = a.known and b.known
    return type(a)(a.middle / b.middle, a.low / b.high if known else None,
                   a.high / b.low if known else None, a.kind)


def versus(name, fast, other, slow, unit="ms"):
    """A sentence on two times, the lower one first."""
    first, second = with_interval(fast, unit), with_interval(slow, unit)
    how = relation(fast, slow)
    if how == "overlap":
        return (f"There is no significant difference between {name} ({first}) and {other} "
                f"({second}): their intervals overlap.")
    sentence = (f"{name} ({first}) is {show(slow.middle / fast.middle)} times as fast as {other} "
                f"({second})")
    return sentence + ("." if how == "apart" else
                       ", by values without a spread: how sure that is was not measured.")


def listed(parts):
    parts = list(parts)
    return " and ".join([", ".join(parts[:-1]), parts[-1]] if len(parts) > 1 else parts)


def exponent(points):
    """p of y = c x^p, least squares over the logarithms; None for a single x."""
    logs = [(math.log(x), math.log(y)) for x, y in points if x > 0 and y > 0]
    if len({x for x, _ in logs}) < 2:
        return None
    mean_x, mean_y = (sum(part) / len(logs) for part in zip(*logs))
    return (sum((x - mean_x) * (y - mean_y) for x, y in logs) /
            sum((x - mean_x) ** 2 for x, _ in logs))
