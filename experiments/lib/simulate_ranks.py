"""Simulates how rank 0 hands out units of an image to the devices of a cluster: a discrete-event
simulation of its queue, of its links and of the devices.

Rank 0 serves one message at a time, first come, first served. A message passes its link, which
carries one at a time in each direction, and arrives a latency later. A device works on one unit at
a time and may have more waiting (Rule.capacity). The network beyond rank 0's link is not limited.
A window has samples enough that no unit waits for another one of the same pixels.
"""
import heapq
import itertools
import math
from collections import deque
from dataclasses import dataclass, field
from random import Random

PIECE_BYTES = 8 << 20  # of a broadcast that is passed on in pieces


@dataclass(frozen=True)
class Rule:
    """How large units are. The image has units_per_device * devices windows. A unit is one of them,
    until work left / (shrink * devices) is smaller (Polychronopoulos and Kuck 1987, 'Guided
    self-scheduling'): then it is a part, at least 1 / parts. `shrink` 0: windows to the end."""
    units_per_device: int
    shrink: float = 0
    parts: int = 1
    capacity: int = 2  # units that a device may have at once
    by_speed: bool = False  # units for slower devices are smaller, in proportion
    by_cost: bool = False  # so are those of windows that are known to cost more than the mean

    def grains(self, left, devices, relative_speed=1.0, cost=1.0):
        """Of the next unit, `left` being what nobody has yet. A grain is 1 / parts of a window."""
        size = self.parts
        if self.shrink:
            size = min(size, left / (self.shrink * devices))
        if self.by_speed:
            size *= relative_speed
        if self.by_cost:
            size /= cost
        return min(max(int(size), 1), self.parts)


@dataclass(frozen=True)
class Job:
    work_s: float  # of all units together, on one device of speed 1
    times: tuple = (1.0,)  # measured times of windows, from which those of all are drawn
    overhead_s: float = 0.0  # of each unit on its device, whatever its size and the device's speed
    film_bytes: float = 0.0  # sums of all pixels
    passes: int = 1  # how many units have samples of the same pixel, one after another
    scene_bytes: float = 0.0
    image_s: float = 0.0  # to develop and write the image, by rank 0 alone


@dataclass(frozen=True)
class Cluster:
    speeds: tuple  # of each device
    starts: tuple = ()  # seconds from the scene's arrival to a device's readiness; (): 0
    local: int = 0  # the first so many devices are rank 0's machine: no link between
    bandwidth: float = math.inf  # bytes/s of rank 0's link, in each direction
    latency_s: float = 0.0
    service_s: float = 0.0  # of rank 0 for a message
    copy_bandwidth: float = math.inf  # bytes/s of rank 0 when it puts a unit into the image
    broadcast: str = "binomial"


@dataclass
class Unit:
    work_s: float
    out_bytes: float  # with the sums that its pixels have already
    into_bytes: float
    origin: object = None  # of whoever made it


@dataclass
class Outcome:
    time_s: float
    efficiency: float  # work over what all devices could have done in that time
    losses: dict  # what the rest of the time went into, as shares of it
    units: int
    service: float  # share of the time in which rank 0 served messages
    link: float  # share in which its link received


def broadcast_s(count, size, bandwidth, latency_s, tree):
    """Of `size` bytes to `count` ranks. binomial: the root sends everything to log2(count) others,
    in pieces or not. binary: each rank passes on each piece to two others as it comes."""
    if size == 0 or count < 2:
        return 0.0
    if tree == "binomial":
        return math.ceil(math.log2(count)) * (latency_s + size / bandwidth)
    depth = math.ceil(math.log2(count + 1)) - 1
    pieces = math.ceil(size / PIECE_BYTES)
    return (pieces + depth - 1) * 2 * (size / pieces) / bandwidth + depth * latency_s


class Line:
    """Serves one after another, in the order of the calls."""

    def __init__(self):
        self.free_s = self.busy_s = 0.0

    def serve(self, now, seconds):
        self.free_s = max(now, self.free_s) + seconds
        self.busy_s += seconds
        return self.free_s


@dataclass
class Device:
    speed: float
    ready_s: float
    is_local: bool
    waiting: deque = field(default_factory=deque)  # units that have come
    is_busy: bool = False
    units: int = 0  # that it has or that are on the way to it
    work_s = overhead_s = end_s = 0.0  # work in seconds of a device of speed 1


class Simulation:
    """One run. An event is (time, number, what is called, its arguments); events of one time are
    in the order in which they were foreseen."""

    def __init__(self, job, cluster, rule, seed):
        self.job, self.cluster, self.rule, self.random = job, cluster, rule, Random(seed)
        count = len(cluster.speeds)
        self.scene_s = broadcast_s(count, job.scene_bytes, cluster.bandwidth, cluster.latency_s,
                                   cluster.broadcast)
        starts = cluster.starts or (0.0,) * count
        self.devices = [Device(speed, self.scene_s + start, number < cluster.local)
                        for number, (speed, start) in enumerate(zip(cluster.speeds, starts))]
        self.left = self.all = count * rule.units_per_device * rule.parts
        self.window_left, self.cost = 0, 1.0  # of the window from which units come now
        self.mean = sum(job.times) / len(job.times)
        self.fastest = max(cluster.speeds)
        self.into, self.out, self.server = Line(), Line(), Line()
        self.events, self.numbers = [], itertools.count()
        self.unit_count, self.time_s = 0, 0.0

    def at(self, time, call, *arguments):
        heapq.heappush(self.events, (time, next(self.numbers), call, arguments))

    def over_link(self, line, now, device, size):
        """When a message of so many bytes has arrived."""
        if device.is_local:
            return now
        return line.serve(now, size / self.cluster.bandwidth) + self.cluster.latency_s

    def arrive(self, now, device, unit):
        """A message at rank 0: the result of a unit, or (None) that the device wants units."""
        copied = unit.into_bytes if unit else 0
        served = self.server.serve(
            now, self.cluster.service_s + copied / self.cluster.copy_bandwidth)
        self.at(served, self.answer, device, unit)

    def answer(self, now, device, unit):
        if unit:
            device.units -= 1
            self.time_s = now
            self.ended(now, device, unit)
        self.hand_out(now, device)

    def hand_out(self, now, device):
        """Whether there was a unit for it."""
        unit = self.take(device) if device.units < self.rule.capacity else None
        if unit is None:
            return False
        device.units += 1
        self.unit_count += 1
        self.at(self.over_link(self.out, now, device, unit.out_bytes), self.receive, device, unit)
        if device.units < self.rule.capacity:
            self.at(now, self.arrive, device, None)
        return True

    def take(self, device):
        """The next unit, or None."""
        if not self.left:
            return None
        if not self.window_left:
            self.window_left = self.rule.parts
            self.cost = self.random.choice(self.job.times) / self.mean
        grains = min(self.window_left,
                     self.rule.grains(self.left, len(self.devices), device.speed / self.fastest,
                                      self.cost))
        self.window_left -= grains
        self.left -= grains
        share = grains / self.all
        return Unit(self.job.work_s * share * self.cost,
                    self.job.film_bytes * (self.job.passes - 1) * share,
                    self.job.film_bytes * self.job.passes * share)

    def ended(self, now, device, unit):
        """For rules that care."""

    def receive(self, now, device, unit):
        device.waiting.append(unit)
        self.begin(now, device)

    def begin(self, now, device):
        if device.is_busy or not device.waiting:
            return
        device.is_busy = True
        unit = device.waiting.popleft()
        device.work_s += unit.work_s
        device.overhead_s += self.job.overhead_s
        self.at(now + self.job.overhead_s + unit.work_s / device.speed, self.end, device, unit)

    def end(self, now, device, unit):
        device.is_busy = False
        device.end_s = now
        self.at(self.over_link(self.into, now, device, unit.into_bytes), self.arrive, device, unit)
        self.begin(now, device)

    def run(self):
        for device in self.devices:
            self.at(device.ready_s, self.ask, device)
        while self.events:
            now, _, call, arguments = heapq.heappop(self.events)
            call(now, *arguments)
        return self.outcome()

    def ask(self, now, device):
        self.at(self.over_link(self.into, now, device, 0), self.arrive, device, None)

    def outcome(self):
        time_s = self.time_s + self.job.image_s
        could = time_s * sum(device.speed for device in self.devices)
        losses = dict.fromkeys(("scene", "start", "overhead", "waiting", "end", "image"), 0.0)
        for device in self.devices:
            # A device that came too late for a unit lost all its time by that.
            ready_s = min(device.ready_s, self.time_s)
            end_s = max(device.end_s, ready_s)
            spent = {"scene": min(self.scene_s, ready_s),
                     "start": ready_s - min(self.scene_s, ready_s), "overhead": device.overhead_s,
                     "waiting": end_s - ready_s - device.overhead_s - device.work_s / device.speed,
                     "end": self.time_s - end_s, "image": self.job.image_s}
            for name, seconds in spent.items():
                losses[name] += seconds * device.speed / could
        work = sum(device.work_s for device in self.devices)
        return Outcome(time_s, work / could, losses, self.unit_count,
                       self.server.busy_s / time_s, self.into.busy_s / time_s)


def simulate(job, cluster, rule, seed=0):
    return Simulation(job, cluster, rule, seed).run()


def cluster_of(nodes, per_node=8, slow_share=0.0, slow_times=1.0, late_share=0.0, late_s=0.0,
               seed=0, **network):
    """`nodes` machines of so many devices. A share of the devices, by chance, is so many times
    slower; the devices of a share of the nodes are ready up to late_s later (uniformly)."""
    random = Random(f"cluster {seed}")
    count = nodes * per_node
    slow = set(random.sample(range(count), round(slow_share * count)))
    late = {node: random.uniform(0, late_s)
            for node in random.sample(range(nodes), round(late_share * nodes))}
    return Cluster(tuple(1 / slow_times if number in slow else 1.0 for number in range(count)),
                   tuple(late.get(number // per_node, 0.0) for number in range(count)),
                   local=per_node, **network)
