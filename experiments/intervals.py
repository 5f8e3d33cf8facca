"""Medians of few measurements, and how sure they are."""
import functools
import itertools
import math
import random
from statistics import median

RESAMPLES = 4000
SEED = 20231122  # fixed: the same times give the same interval
CONFIDENCE = 0.95


def percentile(ordered, share):
    """The least value that at least this share of the ordered values do not exceed."""
    return ordered[max(math.ceil(share * len(ordered)) - 1, 0)]


def ends(ordered):
    outside = (1 - CONFIDENCE) / 2
    return percentile(ordered, outside), percentile(ordered, 1 - outside)


def bootstrap(samples, statistic):
    """(low, high): the percentile interval (Efron 1979, 'Bootstrap methods: another look at the
    jackknife') of a statistic of several independent samples, each drawn again from itself.
    `statistic` takes the list of samples."""
    draw = random.Random(SEED).choices
    return ends(sorted(statistic([draw(sample, k=len(sample)) for sample in samples])
                       for _ in range(RESAMPLES)))


@functools.lru_cache(maxsize=None)
def median_interval(times):
    """(low, high) of the median of a tuple of times; for a single one the time itself."""
    if len(times) ** len(times) <= RESAMPLES:  # few enough to take every possible resample
        return ends(sorted(map(median, itertools.product(times, repeat=len(times)))))
    return bootstrap([times], lambda samples: median(samples[0]))
