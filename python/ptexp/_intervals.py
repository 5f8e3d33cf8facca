"""Medians of few measurements, how sure they are, and which of two is faster.

Here alone: the package's tables, the experiments and their report have these definitions, the
latter two by scripts/report_parts/shared.py. Needs neither the module in C++ nor the package.
"""
import functools
import itertools
import math
import random
from dataclasses import dataclass
from fractions import Fraction
from statistics import median
from typing import Any, Callable, List, Optional, Sequence, Tuple

RESAMPLES = 4000
SEED = 20231122  # fixed: the same times give the same interval
OUTSIDE = Fraction(1, 40)  # below and above an interval of 95 %
SAME = 0.02  # times of one program differ by so much from run to run

Rounds = Tuple[Tuple[float, ...], ...]  # times of each round, in its order


@dataclass(frozen=True)
class Interval:
    """A measured value. `low` and `high` are None where nothing is known about its spread."""

    middle: float
    low: Optional[float] = None
    high: Optional[float] = None
    kind: str = ""

    @property
    def known(self) -> bool:
        return self.low is not None

    def inverse(self) -> "Interval":
        ends = (1 / self.high, 1 / self.low) if self.known else (None, None)  # type: ignore[operator]
        return Interval(1 / self.middle, *ends, self.kind)


def relation(a: Any, b: Any) -> str:
    """'apart', 'overlap', or 'unknown' if the spread of one of them is."""
    if not (a.known and b.known):
        return "unknown"
    return "overlap" if a.low <= b.high and b.low <= a.high else "apart"


def change(default: Any, value: Any) -> Tuple[str, float]:
    """(nvbench's word for `value`, the ratio of the times): 'faster' and 'slower' where intervals
    are apart, 'same' where they overlap and the times are close, else 'ambiguous'."""
    ratio, how = value.middle / default.middle, relation(default, value)
    if how == "apart":
        return "slower" if ratio > 1 else "faster", ratio
    return "same" if how == "overlap" and abs(ratio - 1) <= SAME else "ambiguous", ratio


def percentile(ordered: Sequence[float], share: Fraction) -> float:
    """The least value that at least this share of the ordered values do not exceed."""
    return ordered[max(math.ceil(share * len(ordered)) - 1, 0)]


def ends(ordered: Sequence[float]) -> Tuple[float, float]:
    return percentile(ordered, OUTSIDE), percentile(ordered, 1 - OUTSIDE)


def bootstrap(samples: Sequence[Any], statistic: Callable[[List[List[float]]], float]) -> Tuple[float, float]:
    """(low, high): the percentile interval (Efron 1979, 'Bootstrap methods: another look at the
    jackknife') of a statistic of samples that were measured in the same rounds. A sample is a list
    of rounds, a round a list of times. First the rounds are drawn again, alike for all samples, and
    then the times of each (Davison and Hinkley 1997, 'Bootstrap Methods and their Application',
    3.8): so what differs between rounds counts, and what a round does to all samples alike does
    not. `statistic` takes a list of the samples' times."""
    draw = random.Random(SEED).choices

    def drawn(sample, chosen):  # type: ignore[no-untyped-def]
        return [time for number in chosen for time in draw(sample[number], k=len(sample[number]))]
    values = []
    for _ in range(RESAMPLES):
        chosen = draw(range(len(samples[0])), k=len(samples[0]))
        values.append(statistic([drawn(sample, chosen) for sample in samples]))
    return ends(sorted(values))


@functools.lru_cache(maxsize=None)
def median_interval(rounds: Rounds) -> Tuple[float, float]:
    """(low, high) of the median of a tuple of rounds, tuples of times; of a single time itself."""
    times = tuple(itertools.chain(*rounds))
    is_plain = len(rounds) in (1, len(times))  # drawing rounds or times alone is drawing times
    if is_plain and len(times) ** len(times) <= RESAMPLES:  # few enough to take all there are
        return ends(sorted(map(median, itertools.product(times, repeat=len(times)))))
    return bootstrap([rounds], lambda samples: median(samples[0]))


@functools.lru_cache(maxsize=None)
def interval_of_ratio(top: Rounds, bottom: Rounds) -> Tuple[float, float]:
    """(low, high) of the ratio of two medians, rounds drawn alike for both."""
    return bootstrap([top, bottom], lambda samples: median(samples[0]) / median(samples[1]))


def shares(total: int, rounds: int) -> List[int]:
    """How many of so many repeats each round has: equally many, the first ones what is left over."""
    return [total // rounds + (number < total % rounds) for number in range(rounds)]


def in_rounds(times: Sequence[float], rounds: int) -> List[List[float]]:
    """The times, one after another, as the list of each round's: the harness shares them so."""
    left = iter(times)
    return [list(itertools.islice(left, share)) for share in shares(len(times), rounds)]
