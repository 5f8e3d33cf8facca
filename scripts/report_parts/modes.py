"""Which mode is faster for which work: the one place of the report that says it. A work is a scene
with its image size, samples per pixel and depth.

One rule chooses where tables say different things: the newest complete table that has the work
speaks for it. A table is silent, i.e. listed with its reason but neither shown nor judged, if it
was cut off and a complete one of its experiment exists, if it is much older than the newest, or if
it disagrees with a newer one about the time of the same work with the same options."""
import hashlib
from dataclasses import dataclass
from datetime import datetime
from itertools import dropwhile, takewhile

from .tables import interval, number
from .words import SAME, change, quotient

MODES = ("megakernel", "wavefront")
ANSWERING = ("defaults", "scenes", "sizes")  # experiments that ask which mode is faster
MOST_DAYS = 3  # between a table and the newest: longer ago the program had other rules
# Requests that make no other work: where it ran, where its results went.
NOT_OPTIONS = {"scene", "width", "height", "spp", "max_depth", "output", "exposure", "device", "seed"}


@dataclass(frozen=True)
class Work:
    scene: str
    width: int
    height: int
    spp: int
    depth: int

    @property
    def paths(self):
        return self.width * self.height * self.spp

    @property
    def size(self):
        return f"{self.width}x{self.height}"

    def __str__(self):
        return f"{self.scene} {self.size}, {self.spp} samples, depth {self.depth}"


def work_of(row):
    """None if the row does not say it, or is limited by time and not by samples."""
    scene = "/".join(row.get("scene", "").split("/")[-2:]) or row.get("panel", "")
    numbers = [number(row.get(column)) for column in ("width", "height", "spp", "max_depth")]
    if not scene or None in numbers or numbers[2] >= 2 ** 31 - 1:
        return None
    return Work(scene, *map(int, numbers))


def mode_of(row):
    """The mode that was asked for: megakernel, wavefront, auto."""
    return row.get("variant") if row.get("variant") == "auto" else row.get("mode", "")


def how(table, row):
    """Ten letters that are equal for equal options."""
    from_options = dropwhile(lambda name: name != "fast_math", table.columns)
    options = takewhile(lambda name: name not in ("repeat", "warmup"), from_options)
    asked = [f"{name}={row[name]}" for name in options
             if row[name] and name not in NOT_OPTIONS] + [
        mode_of(row), row.get("device_kind", ""), row.get("device_name", "")]
    return hashlib.sha1("\n".join(asked).encode()).hexdigest()[:10]


def disagree(one, other):
    """Whether two measurements of the same thing are apart, by more than runs of one program are."""
    ratio = one.middle / other.middle
    return (one.known and other.known and abs(ratio - 1) > SAME
            and (one.low > other.high or other.low > one.high))


def measured_works(table):
    """[(work, how, row, interval)]"""
    found = ((work_of(row), row, interval(row, "kernel_ms")) for row in table.measured)
    return [(work, how(table, row), row, value) for work, row, value in found if work and value]


def date_of(table):
    return table.facts.get("date", "")


def is_complete(table):
    return bool(table.facts) and table.facts.get("complete", True) and not table.facts.get("quick")


def days_between(table, other):
    dates = [date_of(one) for one in (table, other)]
    return (abs((datetime.fromisoformat(dates[0]) - datetime.fromisoformat(dates[1])).days)
            if all(dates) else 0)


def newest_first(device):
    return sorted((table for table in device.tables.values() if is_complete(table)),
                  key=date_of, reverse=True)


def why_silent(table, device, spoken):
    """The reason, or nothing. `spoken`: {(work, how): (table, interval)} of newer tables."""
    others = newest_first(device)
    experiment = table.facts.get("experiment")
    if not is_complete(table):
        better = next((one for one in others if one.facts.get("experiment") == experiment), None)
        return f"cut off; {better.name} is complete" if better else ""
    days = days_between(table, others[0])
    if days > MOST_DAYS:
        return f"measured {days} days before {others[0].name}"
    for work, options, row, value in measured_works(table):
        newer = spoken.get((work, options))
        if newer and disagree(value, newer[1]):
            return f"disagrees with {newer[0].name}, which is newer ({work}, {mode_of(row)})"
    return ""


def silent(device):
    """{name: reason} of the tables that have no section."""
    if device.silent is None:
        spoken, device.silent = {}, {}
        tables = newest_first(device)
        for table in tables + [one for one in device.tables.values()
                               if one.facts and one not in tables and not one.facts.get("quick")]:
            reason = why_silent(table, device, spoken)
            if reason:
                device.silent[table.name] = reason
                continue
            for work, options, _, value in measured_works(table):
                spoken.setdefault((work, options), (table, value))
    return device.silent


@dataclass
class Verdict:
    """What a table says of a work."""
    work: Work
    table: object
    times: dict  # by mode: (interval, row) with the fastest options measured
    auto: dict  # the row of --mode auto, or nothing

    @property
    def ratio(self):
        """The megakernel's time over the wavefront's."""
        return quotient(*(self.times[mode][0] for mode in MODES))

    @property
    def word(self):
        """The wavefront is ... (than the megakernel)."""
        return change(*(self.times[mode][0] for mode in MODES))[0]

    @property
    def commit(self):
        return self.times[MODES[0]][1].get("commit", "")[:7]

    @property
    def loss(self):
        """By how much of the faster mode's time auto's mode is slower; None: not measured."""
        mode = self.auto.get("used_mode")
        return self.loss_of(mode) if mode in MODES else None

    def loss_of(self, mode):
        times = {name: value.middle for name, (value, _) in self.times.items()}
        return times[mode] / min(times.values()) - 1


def verdicts(device):
    """{work: verdict} of all works that both modes were measured with, each by the newest table."""
    found = {}
    for table in newest_first(device):
        if table.name in silent(device) or not {
                table.name, table.facts.get("experiment")} & set(ANSWERING):
            continue
        kinds = {row.get("device_kind") for row in table.measured}
        of_work = {}
        for work, _, row, value in measured_works(table):
            if "cuda" in kinds and row.get("device_kind") != "cuda":
                continue
            mode, times = mode_of(row), of_work.setdefault(work, {})
            if mode not in times or value.middle < times[mode][0].middle:
                times[mode] = value, row
        for work, times in of_work.items():
            if set(MODES) <= set(times):
                found.setdefault(work, Verdict(work, table, {mode: times[mode] for mode in MODES},
                                               times.get("auto", (None, {}))[1]))
    return found


def one_for_each_scene(found):
    """The verdicts that the report's table of scenes has: a scene's newest table, and there the
    work with most paths, then the deepest."""
    chosen = {}
    for verdict in found.values():
        rank = date_of(verdict.table), verdict.work.paths, verdict.work.depth
        if verdict.work.scene not in chosen or rank > chosen[verdict.work.scene][0]:
            chosen[verdict.work.scene] = rank, verdict
    return sorted((verdict for _, verdict in chosen.values()),
                  key=lambda verdict: verdict.ratio.middle)
