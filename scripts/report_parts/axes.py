"""Scales of a plot: values to places, and where the ticks are."""
import math


class Scale:
    def __init__(self, low, high, log, start, end):
        self.low, self.high, self.log, self.start, self.end = low, high, log, start, end

    def __call__(self, value):
        low, high = self.low, self.high
        if self.log:
            low, high, value = math.log(low), math.log(high), math.log(value)
        return self.start + (value - low) / (high - low) * (self.end - self.start)

    def ticks(self):
        if not self.log:
            return even(self.low, self.high)
        decades = range(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)) + 1)
        for steps in ((1, 2, 5), (1,)):
            places = [step * 10.0 ** decade for decade in decades for step in steps]
            places = [place for place in places if self.low <= place <= self.high]
            if len(places) <= 9:
                break
        return places if len(places) >= 3 else even(self.low, self.high)


def even(low, high):
    """At most seven round numbers."""
    rough = (high - low) / 6
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(step * power for step in (1, 2, 5, 10) if step * power >= rough)
    first = math.ceil(low / step - 1e-9)
    return [round(place * step, 12) for place in range(first, math.floor(high / step + 1e-9) + 1)]


def domain(values, log):
    """From the lowest to the highest with some air; without a logarithm from 0."""
    ends = [end for value in values
            for end in (value.middle, *((value.low, value.high) if value.known else ()))]
    ends = [end for end in ends if end > 0 or not log] or [1]
    if log:
        return min(ends) / 1.3, max(ends) * 1.3
    return min(0, *ends), max(ends) * 1.06 or 1
