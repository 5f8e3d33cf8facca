"""Measures all configurations once in each round, so that a machine that drifts hits all alike."""
import time

from lib import program as ptexp
from lib.description import HarnessError, Refused
from lib.intervals import shares
from lib.pooling import pooled
from lib.provenance import machine_state, scene_hash
from lib.resident import ONE, Resident

OWN = {"experiment", "name", "status", "message", "rounds", "kernel_ms_low", "kernel_ms_high",
       "kernel_ms_runs", "scene_hash"}


def repeats(configuration, arguments):
    """(repeats in each round, warm-up of each): the rounds share what was asked for. In a round
    without repeats the configuration is left out."""
    total, warmup = configuration.repeat or arguments.repeat, arguments.warmup
    if configuration.repeat:
        warmup = configuration.warmup
    return shares(total, arguments.rounds), warmup


def command_line(session, configuration, number=0):
    shares, warmup = repeats(configuration, session.arguments)
    return ptexp.command_line(session.program, configuration, session.device, shares[number],
                              warmup)


def plan(session):
    """(round, configuration) of every measurement, in order: every second round goes backwards, so
    that nothing always comes after the same."""
    return [(number, configuration) for number in range(session.arguments.rounds)
            for configuration in session.configurations[::-1 if number % 2 else 1]
            if repeats(configuration, session.arguments)[0][number]]


def row_of(session, journal, configuration):
    """`pending`: not all rounds are measured; the columns are those of the rounds that are."""
    processes = journal.processes(configuration.name)
    wrong = [process for process in processes if process.status != "measured"]
    asked = sum(map(bool, repeats(configuration, session.arguments)[0]))
    status = (wrong[0].status if wrong else
              "measured" if len(processes) == asked else "pending")
    row = {"experiment": session.experiment.name, "name": configuration.name, "status": status,
           "message": wrong[0].message if wrong else "", **configuration.labels}
    columns = {}
    if processes and not wrong:
        made = configuration.name, len(processes)
        if made not in session.pooled:
            session.pooled[made] = pooled(processes, session.experiment.whole_process)
        columns = session.pooled[made]
    clash = set(configuration.labels) & (OWN | set(columns))
    if clash:
        raise HarnessError(f"ptexp's CSV or the harness has columns {sorted(clash)} already")
    scene = scene_hash(configuration.arguments) if configuration.renders else ""
    return {**row, "scene_hash": scene, **columns}


def rows_of(session, journal):
    """A row for every configuration: name, status, message, labels, then ptexp's own columns."""
    rows = [row_of(session, journal, configuration) for configuration in session.configurations]
    fullest = max(rows, key=len)
    return [{**dict.fromkeys([*row, *fullest], ""), **row} for row in rows]


def left_text(seconds):
    if seconds < 90:
        return f"about {max(round(seconds), 1)} s left"
    if seconds < 90 * 60:
        return f"about {round(seconds / 60)} min left"
    return f"about {seconds / 3600:.1f} h left"


class Progress:
    """Prints a line for each measurement; the time left follows from their mean time."""

    def __init__(self, total, done):
        self.total, self.done, self.here, self.start = total, done, 0, time.monotonic()

    def skip(self):
        self.done += 1

    def say(self, name, process):
        self.done, self.here = self.done + 1, self.here + 1
        left = (time.monotonic() - self.start) / self.here * (self.total - self.done)
        times = sorted(run["kernel_ms"] for run in process.runs)
        result = (f"{times[len(times) // 2]:.4g} ms" if times else
                  process.message or f"{process.wall_ms:.4g} ms")
        more = f"  ({left_text(left)})" if self.done < self.total else ""
        print(f"{self.done}/{self.total}  {name}: {result}{more}", flush=True)


def measured(session, resident, configuration, number):
    try:
        if configuration.prepare:
            configuration.prepare()
    except (Refused, OSError) as error:
        return ptexp.Process("refused", str(error))
    timeout_s = session.arguments.timeout
    if configuration.renders and (configuration.way or session.way) == ONE:
        shares, warmup = repeats(configuration, session.arguments)
        return resident.measure(configuration, session.device, shares[number], warmup, timeout_s)
    return ptexp.measure(command_line(session, configuration, number), timeout_s,
                         configuration.renders)


def measure_all(session, journal, save):
    """Measures what the journal lacks; `save` is called after each measurement."""
    with Resident(session.program) as resident:
        measure_missing(session, journal, save, resident)


def measure_missing(session, journal, save, resident):
    done = {(event["round"], event["name"]) for event in journal.of("process")}
    work = plan(session)
    todo = [(number, c) for number, c in work if (number, c.name) not in done]
    wrong = {event["name"] for event in journal.of("process") if event["status"] != "measured"}
    progress = Progress(len(work), len(work) - len(todo))
    for number in range(session.arguments.rounds):
        of_round = [c for in_round, c in todo if in_round == number]
        if of_round:
            journal.add("machine", round=number, when="begin", **machine_state())
        for configuration in of_round:
            if configuration.name in wrong:
                progress.skip()
                continue
            process = measured(session, resident, configuration, number)
            journal.add_process(configuration.name, number, process)
            if process.status != "measured":
                wrong.add(configuration.name)
            progress.say(configuration.name, process)
            save()
        if of_round:
            journal.add("machine", round=number, when="end", **machine_state())
