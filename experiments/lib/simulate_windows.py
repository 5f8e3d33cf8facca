"""The rule of src/common/distribute for units, for the simulation of many ranks (simulate_ranks.py):
windows of rows by factoring (unit_queue.cpp), which take samples by portions of some seconds, as
fast as their device was with its last unit (group_renderer.cpp). A window is with one device at a
time. What a pixel costs is read from a map, rows of numbers over the image.
"""
import heapq
import itertools
from dataclasses import dataclass

from lib.simulate_ranks import Simulation, Unit

WINDOW_PIXELS_MAX = 1 << 21


@dataclass(frozen=True)
class WindowRule:
    width: int
    height: int
    unit_s: float = 1
    even_s: float = 20  # while so much is left, the image grows evenly
    smallest_share: int = 64  # windows have at least 1 / so much of a device's share of the pixels
    first_share: float = 4  # the first windows have 1 / so much of it
    first_s: float = 0.3  # of a device's first unit, before its speed is known
    capacity: int = 2
    round_up: bool = True  # to whole rows, else down


class CostMap:
    """Sums of costs over pixels in their order, row after row, or over whole rows; the mean is 1."""

    def __init__(self, rows, width, height):
        self.width, self.height = width, height
        mean = sum(map(sum, rows)) / sum(map(len, rows))
        self.rows = [[cost / mean for cost in row] for row in rows]
        self.means = [sum(row) / len(row) for row in self.rows]

    def mean_of_rows(self, y, height):
        first, end = (row * len(self.rows) / self.height for row in (y, y + height))
        return self.mean(self.means, first, end)

    def mean_in_row(self, y, x, width):
        row = self.rows[y * len(self.rows) // self.height]
        first, end = (column * len(row) / self.width for column in (x, x + width))
        return self.mean(row, first, end)

    @staticmethod
    def mean(values, first, end):
        total = 0.0
        for i in range(int(first), min(int(end) + 1, len(values))):
            total += values[i] * max(min(end, i + 1) - max(first, i), 0)
        return total / (end - first)


@dataclass
class Window:
    pixels: int
    cost: float  # of a pixel, the image's mean being 1
    done: float = 0.0  # share of its samples
    version: int = 0  # of its entries in the heaps


def divide(rule, workers, costs):
    """As divide_pixels()."""
    left = rule.width * rule.height
    least = min(WINDOW_PIXELS_MAX, max(left // (rule.smallest_share * workers), 1))
    x = y = 0
    windows = []

    def cut(pixels):
        nonlocal x, y
        if x or pixels < rule.width:
            width = min(pixels, rule.width - x)
            windows.append(Window(width, costs.mean_in_row(y, x, width)))
            x += width
            if x == rule.width:
                x, y = 0, y + 1
            return width
        rows = -(-pixels // rule.width) if rule.round_up else pixels // rule.width
        rows = min(rows, rule.height - y)
        windows.append(Window(rows * rule.width, costs.mean_of_rows(y, rows)))
        y += rows
        return rows * rule.width
    while left:
        pixels = min(max(int(left / (rule.first_share * workers)), least), WINDOW_PIXELS_MAX)
        for _ in range(workers):
            if left:
                left -= cut(pixels)
    return windows


class WindowSimulation(Simulation):
    def __init__(self, job, cluster, rule, costs):
        super().__init__(job, cluster, _Plain(rule.capacity), 0)
        self.windows_rule = rule
        self.windows = divide(rule, len(self.devices), costs)
        self.pixels = rule.width * rule.height
        whole = sum(window.pixels * window.cost for window in self.windows)
        self.pixel_s = job.work_s / whole
        self.largest = max(window.pixels for window in self.windows)
        self.lacking, self.behind, self.order = [], [], itertools.count()
        for window in self.windows:
            self.enter(window)
        self.paths_left = sum(window.pixels for window in self.windows)
        self.rates, self.hungry = {}, []

    def enter(self, window):
        """Into both heaps."""
        entry = next(self.order), window.version, window
        heapq.heappush(self.lacking, (-(1 - window.done) * window.pixels, *entry))
        heapq.heappush(self.behind, (window.done, *entry))

    def pick(self, heap):
        while heap:
            _, _, version, window = heapq.heappop(heap)
            if version == window.version:
                window.version += 1  # the other heap's entry is void, too
                return window
        return None

    def take(self, device):
        """A path is a pixel with all of its samples, here."""
        rule = self.windows_rule
        is_even = self.paths_left > rule.even_s * sum(self.rates.values())
        is_even = is_even and bool(self.rates)
        window = self.pick(self.behind if is_even else self.lacking)
        if window is None:
            if device not in self.hungry:
                self.hungry.append(device)
            return None
        rate = self.rates.get(id(device))
        paths = rule.unit_s * rate if rate else rule.first_s / self.pixel_s
        fitting = paths / (self.largest if is_even else window.pixels)
        left = 1 - window.done
        part = left if left <= 1.5 * fitting else fitting
        size = self.job.film_bytes * window.pixels / self.pixels
        return Unit(part * window.pixels * window.cost * self.pixel_s,
                    size if window.done else 0, size, (window, part))

    def ended(self, now, device, unit):
        window, part = unit.origin
        seconds = unit.work_s / device.speed
        if seconds > 0:
            self.rates[id(device)] = part * window.pixels / seconds
        self.paths_left -= part * window.pixels
        window.done = min(window.done + part, 1)
        if window.done < 1 - 1e-9:
            self.enter(window)
            hungry, self.hungry = self.hungry, []
            for other in hungry:
                self.hand_out(now, other)


@dataclass(frozen=True)
class _Plain:
    """What Simulation itself asks of a rule."""
    capacity: int
    units_per_device: int = 0
    parts: int = 1


def simulate_windows(job, cluster, rule, rows):
    costs = CostMap(rows, rule.width, rule.height)
    return WindowSimulation(job, cluster, rule, costs).run()
