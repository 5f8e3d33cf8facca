"""Measures ptexp in the configurations of an experiment and writes one table of the results.

An experiment is a script that describes itself by an Experiment and calls main(). One process of
ptexp measures all configurations where it can (resident.py), else each is a process in each round.
The table is DIR/DEVICE/EXPERIMENT.csv; the
file EXPERIMENT.json beside it says how, when and where it was measured. docs/experiments.md tells
more.
"""
import os
import shlex
import sys

# What experiments need, so that they import this module alone.
from lib.description import Configuration, Experiment, HarnessError, Plot, Refused  # noqa: F401
from lib.image_check import check_images
from lib.journal import Journal
from lib.options import parse_arguments
from lib.program import ROOT, check_gpu, find_device, find_program, run_ptexp  # noqa: F401
from lib.provenance import now, provenance  # noqa: F401
from lib.resident import way_of
from lib.rounds import command_line, measure_all, plan, rows_of
from lib.scene_files import by_python
from lib.session import Session, constant_origin, is_complete, key_of, origin
from lib.table import read_facts, read_rows, table_path, table_text, write_table  # noqa: F401


def draw(path):
    """Draws the table if it can: the numbers are safe by now."""
    try:
        from lib import plot  # pylint: disable=import-outside-toplevel
    except ImportError as error:
        return f"no plot: {error}; experiments/README.md says how to install matplotlib"
    return f"wrote {plot.draw(path)}"


def program_and_device(arguments, counts_lanes=False):
    """Those that --ptexp and --device name."""
    program = find_program(arguments.ptexp, counts_lanes)
    return program, find_device(program, arguments.device)


def list_commands(program, commands):
    """What --list prints, and its exit code."""
    for command in commands:
        print(shlex.join([str(program), *command]))
    return 0


def session_of(experiment, arguments):
    """Finds program and device, and asks the experiment for its configurations."""
    given = dict(vars(arguments))  # before configurations() adds anything
    program, device = program_and_device(arguments)
    device.calibration = arguments.calibration
    configurations = list(map(by_python, experiment.configurations(arguments, device)))
    names = [configuration.name for configuration in configurations]
    if len(set(names)) < len(names):
        raise HarnessError(f"{experiment.name}: two configurations have one name")
    session = Session(experiment, arguments, program, device, configurations)
    session.key = key_of(session, given)
    session.way = way_of(experiment, arguments, configurations)
    return session


def open_journal(session):
    """The journal, begun or resumed. Without its image a configuration is not measured yet."""
    images = {c.name: c.image for c in session.configurations if os.path.isabs(c.image)}
    journal = Journal(session.path.with_suffix(".journal"), session.key, session.arguments.fresh,
                      lambda name: name not in images or os.path.exists(images[name]))
    done = len(journal.of("process"))
    if done:
        print(f"goes on: {done} of {len(plan(session))} measurements are done already "
              "(--fresh starts anew)", flush=True)
    journal.begin(date=now(), command=shlex.join(sys.argv))
    return journal


def measure(session, journal):
    """Measures what is missing, and writes the table after each process; returns the part of its
    origin that no measurement changes."""
    constant = constant_origin(session)

    def save():
        rows = rows_of(session, journal)
        if any(row.get("kernel_ms_median") for row in rows):  # else the old table stays
            write_table(session.path, rows, origin(session, journal, constant))
    check_images(session, journal)
    measure_all(session, journal, save)
    return constant


def report(session, journal, constant):
    """Fills in what needs all rows, writes and prints the table; returns the exit code."""
    experiment, arguments = session.experiment, session.arguments
    rows = rows_of(session, journal)
    measured = [row for row in rows if row["status"] == "measured"]
    failed = [row for row in rows if row["status"] == "failed"]
    if not measured:
        journal.remove()
        did = "failed in or refused" if failed else "refused"
        raise HarnessError(f"ptexp {did} every configuration, the first with: "
                           f"{rows[0]['message']}; no result was written")
    experiment.finish(measured, arguments)
    facts = {**origin(session, journal, constant), "complete": not failed,
             "conclusions": experiment.conclude(measured, arguments)}
    write_table(session.path, rows, facts)
    if not failed:
        journal.remove()
    print_table(session, rows, facts["conclusions"])
    for row in failed:
        print(f"{experiment.name}: failed: {row['name']}: {row['message']}", file=sys.stderr)
    return 1 if failed else 0


def print_table(session, rows, conclusions):
    print("\n".join(["", table_text(rows, session.experiment.table), "", *conclusions,
                     f"table: {session.path}",
                     *([draw(session.path)] if session.experiment.plot else [])]))


def run(experiment, arguments):
    session = session_of(experiment, arguments)
    if arguments.list:
        for configuration in session.configurations:
            print(shlex.join(command_line(session, configuration)))
        return 0
    device = session.device
    check_gpu(experiment, device)
    print(f"{experiment.question}\non {device.choice}: {device.name} ({device.detail}), by {session.way}",
          flush=True)
    session.path = table_path(experiment, device, arguments)
    if not arguments.fresh and is_complete(session.path, session.key):
        print("measured already by this program and command (--fresh measures again)")
        print_table(session, read_rows(session.path),
                    read_facts(session.path).get("conclusions", []))
        return 0
    journal = open_journal(session)
    try:
        constant = measure(session, journal)
    except KeyboardInterrupt:
        print(f"{experiment.name}: interrupted; the same command goes on, and {session.path} has "
              "what it measured", file=sys.stderr)
        return 130
    return report(session, journal, constant)


def main(experiment, command=None, runner=run):
    """Runs the experiment as the command line says; returns the exit code: 0, 1 if a configuration
    failed, 2 if there is no whole table, 130 after Ctrl-C. `runner`, called with the experiment and
    the arguments, measures, writes the table and returns the code, or None for 0."""
    arguments = parse_arguments(experiment, command)
    try:
        return runner(experiment, arguments) or 0
    except BrokenPipeError:  # whoever read the output has gone
        sys.stdout = None
        return 1
    except (HarnessError, OSError) as error:
        print(f"{experiment.name}: error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print(f"{experiment.name}: interrupted", file=sys.stderr)
        return 130
