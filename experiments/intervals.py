"""Medians of few measurements, and how sure they are."""
import functools
import math
import random
from statistics import median

RESAMPLES = 4000
SEED = 20231122  # fixed: the same times give the same interval
CONFIDENCE = 0.95


def percentile(ordered, share):
    """The least value that at least this share of the ordered values do not exceed."""
    return ordered[max(math.ceil(share * len(ordered)) - 1, 0)]


def bootstrap(samples, statistic):
    """(low, high): the percentile interval (Efron 1979, 'Bootstrap methods: another look at the
    jackknife') of a statistic of several independent samples, each drawn again from itself.
    `statistic` takes the list of samples."""
    draw = random.Random(SEED).choices
    values = sorted(statistic([draw(sample, k=len(sample)) for sample in samples])
                    for _ in range(RESAMPLES))
    outside = (1 - CONFIDENCE) / 2
    return percentile(values, outside), percentile(values, 1 - outside)


@functools.lru_cache(maxsize=None)
def median_interval(times):
    """(low, high) of the median of a tuple of times; for a single one the time itself."""
    if len(times) == 1:
        return times[0], times[0]
    return bootstrap([times], lambda samples: median(samples[0]))
