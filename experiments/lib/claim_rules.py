"""Evaluates the rules of experiments/claims: rows of a table become cases, each a value with an
interval. Rules are data; nothing in them is executed."""
import math
import sys
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase

from lib.program import ROOT
from lib.ratios import ratio_interval

sys.path.insert(0, str(ROOT / "scripts"))
# pylint: disable=wrong-import-position
from report_parts.tables import Interval, in_groups, interval, is_measured, number  # noqa: E402
from report_parts.words import plain, quotient  # noqa: E402

BOOTSTRAP = "bootstrap over rounds"


@dataclass
class Cell:
    """One case."""
    labels: dict  # {our word: value}
    value: Interval
    commits: tuple
    assumed: bool = False  # whether the interval is


def inside(value, rule):
    return value.known and (value.low >= rule.get("at_least", -math.inf)
                            and value.high <= rule.get("at_most", math.inf))


def outside(value, rule):
    return value.known and (value.high < rule.get("at_least", -math.inf)
                            or value.low > rule.get("at_most", math.inf))


def matches(row, selection):
    """Whether the row's columns have the values, in which * and ? stand for any letters."""
    for column, patterns in selection.items():
        # A bracket is a letter like others: none of our columns needs sets of letters.
        wanted = [pattern.replace("[", "[[]") for pattern in (
            [patterns] if isinstance(patterns, str) else patterns)]
        if not any(fnmatchcase(row.get(column, ""), pattern) for pattern in wanted):
            return False
    return True


def scaled(value, factor):
    ends = (value.low * factor, value.high * factor) if value.known else (None, None)
    return Interval(value.middle * factor, *ends, value.kind)


def factor_of(row, rule):
    """By which the row's value is multiplied; None if it is not known."""
    factor = 1.0
    for key, power in (("times", 1), ("per", -1)):
        if key in rule:
            found = number(row.get(rule[key]))
            if not found:
                return None
            factor *= found ** power
    return factor


def value_of(row, rule):
    """(value, whether its interval is assumed), or None."""
    value, factor = interval(row, rule.get("column", "kernel_ms")), factor_of(row, rule)
    if value is None or factor is None or not is_measured(row):
        return None
    assumed = not value.known and "assumed_spread" in rule
    if assumed:
        spread = rule["assumed_spread"]
        value = replace(value, low=value.middle * (1 - spread), high=value.middle * (1 + spread))
    return scaled(value, factor), assumed


def commits_of(*rows):
    return tuple(dict.fromkeys(row["commit"][:7] for row in rows if row.get("commit")))


def fastest(rows, rule):
    """The row with the least value, None if no row has one."""
    found = [(value[0].middle, place) for place, value in enumerate(
        value_of(row, rule) for row in rows) if value]
    return rows[min(found)[1]] if found else None


def ratio_of(top, bottom, labels, rule):
    """The case of two rows: by bootstrap where both tell the times of all repeats, else with the
    ends that the ends of both allow."""
    (above, assumed), (below, also) = value_of(top, rule), value_of(bottom, rule)
    if below.middle == 0:
        raise ValueError(f"{rule.get('column', 'kernel_ms')} is 0 in a row of the denominator")
    value = quotient(above, below)
    ends = ratio_interval(top, bottom) if rule.get("column", "kernel_ms") == "kernel_ms" else None
    if ends:
        factor = factor_of(top, rule) / factor_of(bottom, rule)
        value = Interval(value.middle, *(end * factor for end in ends), BOOTSTRAP)
    return Cell(labels, value, commits_of(top, bottom), assumed or also)


def ratios(rows, labels, rule):
    bottom = fastest([row for row in rows if matches(row, rule["denominator"])], rule)
    varied = rule.get("vary", {})
    for key, tops in in_groups([row for row in rows if matches(row, rule["numerator"])],
                               *varied.values(), "").items():
        top = fastest(tops, rule)
        if top and bottom:
            yield ratio_of(top, bottom, {**labels, **dict(zip(varied, key))}, rule)


def in_order(rows, rule):
    """Rows with a value and a place, by it."""
    along = rule["along"]
    found = [row for row in rows if value_of(row, rule) and number(row.get(along)) is not None]
    return sorted(found, key=lambda row: number(row[along]))


def steps(rows, labels, rule):
    """Each row over the one before it."""
    ordered = in_order(rows, rule)
    for before, row in zip(ordered, ordered[1:]):
        ends = [plain(number(one[rule["along"]])) for one in (before, row)]
        yield ratio_of(row, before, {**labels, "step": " to ".join(ends)}, rule)


def exponents(rows, labels, rule):
    """p of y = c x^p from the first row to the last."""
    ordered = in_order(rows, rule)
    places = [number(row[rule["along"]]) for row in ordered]
    if len(ordered) < 2 or not 0 < places[0] < places[-1]:
        return
    cell, growth = ratio_of(ordered[-1], ordered[0], labels, rule), math.log(places[-1] / places[0])
    ends = (cell.value.low, cell.value.high) if cell.value.known else ()
    cell.value = Interval(*(math.log(end) / growth for end in (cell.value.middle, *ends)))
    yield cell


def values(rows, labels, rule):
    found = [(value_of(row, rule), row) for row in rows]
    found = [(value, row) for value, row in found if value]
    if len(found) > 1:
        raise ValueError(f"{len(found)} rows for {', '.join(labels.values()) or 'the only case'}; "
                         "for_each should tell them apart")
    for (value, assumed), row in found:
        yield Cell(labels, value, commits_of(row), assumed)


def measured(rows, labels, _rule):
    """1 where a row was measured, 0 where the program refused or failed it."""
    if rows:
        done = float(any(map(is_measured, rows)))
        yield Cell(labels, Interval(done, done, done), commits_of(*rows))


KINDS = {"ratio": ratios, "steps": steps, "exponent": exponents, "value": values,
         "measured": measured}


def cells_of(table, rule):
    """The cases of a table, in its order."""
    rows = [row for row in table.rows if matches(row, rule.get("where", {}))]
    words, cells = rule.get("for_each", {}), []
    for key, members in in_groups(rows, *words.values(), "").items():
        if "last_of" in rule:
            places = [number(row.get(rule["last_of"])) for row in members]
            last = max((place for place in places if place is not None), default=None)
            members = [row for row, place in zip(members, places) if place == last]
        cells += KINDS[rule["statistic"]](members, dict(zip(words, key)), rule)
    return cells
