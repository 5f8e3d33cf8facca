"""Medians of few measurements, and how sure they are."""
import functools
import itertools
import math
import random
from fractions import Fraction
from statistics import median

RESAMPLES = 4000
SEED = 20231122  # fixed: the same times give the same interval
OUTSIDE = Fraction(1, 40)  # below and above an interval of 95 %


def percentile(ordered, share):
    """The least value that at least this share of the ordered values do not exceed."""
    return ordered[max(math.ceil(share * len(ordered)) - 1, 0)]


def ends(ordered):
    return percentile(ordered, OUTSIDE), percentile(ordered, 1 - OUTSIDE)


def bootstrap(samples, statistic):
    """(low, high): the percentile interval (Efron 1979, 'Bootstrap methods: another look at the
    jackknife') of a statistic of samples that were measured in the same rounds. A sample is a list
    of rounds, a round a list of times. First the rounds are drawn again, alike for all samples, and
    then the times of each (Davison and Hinkley 1997, 'Bootstrap Methods and their Application',
    3.8): so what differs between rounds counts, and what a round does to all samples alike does
    not. `statistic` takes a list of the samples' times."""
    draw = random.Random(SEED).choices

    def drawn(sample, chosen):
        return [time for number in chosen for time in draw(sample[number], k=len(sample[number]))]
    values = []
    for _ in range(RESAMPLES):
        chosen = draw(range(len(samples[0])), k=len(samples[0]))
        values.append(statistic([drawn(sample, chosen) for sample in samples]))
    return ends(sorted(values))


@functools.lru_cache(maxsize=None)
def median_interval(rounds):
    """(low, high) of the median of a tuple of rounds, tuples of times; of a single time itself."""
    times = tuple(itertools.chain(*rounds))
    is_plain = len(rounds) in (1, len(times))  # drawing rounds or times alone is drawing times
    if is_plain and len(times) ** len(times) <= RESAMPLES:  # few enough to take all there are
        return ends(sorted(map(median, itertools.product(times, repeat=len(times)))))
    return bootstrap([rounds], lambda samples: median(samples[0]))


def in_rounds(times, rounds):
    """The times, one after another, as the list of each round's: the harness shares them so."""
    shares = [len(times) // rounds + (number < len(times) % rounds) for number in range(rounds)]
    left = iter(times)
    return [list(itertools.islice(left, share)) for share in shares]
