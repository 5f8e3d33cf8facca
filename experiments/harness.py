"""Measures ptexp in the configurations of an experiment and writes one table of the results.

An experiment is a script that describes itself by an Experiment and calls main(). Every
configuration is one process of ptexp. The table is DIR/DEVICE/EXPERIMENT.csv; the file
EXPERIMENT.json beside it says how, when and where it was measured. README.md tells more.
"""
import argparse
import contextlib
import csv
import datetime
import io
import json
import os
import platform
import re
import shlex
import subprocess
import sys
import tempfile
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Callable

ROOT = Path(__file__).resolve().parent.parent
PROGRAMS = ["build/release/src/ptexp", "install/bin/ptexp"]  # below ROOT, unless named


class HarnessError(Exception):
    """Ends the experiment; its text is one line for the user."""


class Refused(HarnessError):
    """ptexp took offence at an option, or at what the option needs."""


@dataclass
class Device:
    choice: str  # as --device takes it
    name: str
    detail: str

    @property
    def kind(self):
        return self.choice.partition(":")[0]


@dataclass
class Configuration:
    name: str  # unique in its experiment
    arguments: str  # of ptexp; the harness adds device, repeats and files
    labels: dict = field(default_factory=dict)  # columns of the experiment's own
    device: str = ""  # "": the experiment's device
    repeat: int = 0  # 0: as the command line says; then warmup is the command line's too
    warmup: int = 0
    image: str = ""  # a whole path, where `finish` needs it; else no image is kept


@dataclass
class Plot:
    """How plot.py draws the table. Rows with one label `panel` share axes; in `lines`, rows with
    one label `series` share a line; the label `x` is the place on the axis, a number for lines, and
    nothing for a row that the picture leaves out."""
    kind: str  # "lines" or "bars"
    title: str
    x_label: str = ""
    y_label: str = "kernel time [ms]"
    y: str = "kernel_ms"  # the columns y_median, y_min, y_max
    log_y: bool = True
    mark: float = None  # a value of y that a line marks


def no_arguments(_parser):
    """For experiments without options of their own."""


def no_columns(_rows, _arguments):
    """For experiments whose labels are known before the measurement."""


def no_check(_program, _device, _arguments):
    """For experiments that take the images as they come."""


def no_conclusions(_rows, _arguments):
    """For experiments whose table says it all."""
    return []


@dataclass
class Experiment:
    name: str
    question: str
    configurations: Callable  # (arguments, device) -> list of Configuration; None: see main()
    plot: Plot  # None: a table without a picture
    add_arguments: Callable = no_arguments
    finish: Callable = no_columns  # fills in labels of measured rows: (rows, arguments)
    table: tuple = ()  # labels to print besides name and time
    # Raises HarnessError before the measurement, if images are not as they should be: (program,
    # device, arguments).
    check: Callable = no_check
    conclude: Callable = no_conclusions  # sentences for below the table: (rows, arguments)


def find_program(named):
    """The path of ptexp: --ptexp, else $PTEXP, else what was built or installed here."""
    named = named or os.environ.get("PTEXP")
    candidates = [Path(named)] if named else [ROOT / path for path in PROGRAMS]
    for path in candidates:
        if path.is_file() and os.access(path, os.X_OK):
            return path.resolve()
    raise HarnessError(f"no program {' or '.join(map(str, candidates))}: build it (scripts/render) "
                       "or name it with --ptexp")


def output_of(*command):
    """What a command prints, or nothing where there is no such command."""
    try:
        run = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60)
    except (OSError, subprocess.SubprocessError):
        return ""
    return run.stdout.strip()


def run_ptexp(program, *arguments):
    """What ptexp prints. 1 is no failure: `compare` has found a difference."""
    run = subprocess.run([program, *arguments], capture_output=True, text=True, check=False,
                         stdin=subprocess.DEVNULL)
    if run.returncode not in (0, 1):
        kind = Refused if run.returncode == 2 else HarnessError
        raise kind(f"{shlex.join(map(str, arguments))}: {run.stderr.strip()}")
    return run.stdout


def find_device(program, wanted):
    """The device that --device names; auto: the first GPU if there is one, else the CPU."""
    lines = re.findall(r"(?m)^(\S+)\s+(.*) \((.*)\)$", output_of(program, "--list-devices"))
    devices = [Device(*line) for line in lines]
    order = sorted(devices, key=lambda device: device.kind != "cuda")
    for device in order:
        if wanted in ("auto", device.choice, device.kind):
            return device
    raise HarnessError(f"--device {wanted}: {program} lists "
                       f"{', '.join(device.choice for device in devices) or 'no device'}")


def cpu_model():
    with contextlib.suppress(OSError):
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
        found = re.search(r"(?m)^model name\s*:\s*(.+)$", text)
        if found:
            return found.group(1)
    return platform.machine()


def system_name():
    with contextlib.suppress(OSError, KeyError):
        return platform.freedesktop_os_release()["PRETTY_NAME"]
    return platform.system()


def device_folder(device):
    """E.g. nvidia-h200, or cpu-amd-epyc-9654: a folder's results come from one kind of machine."""
    name = device.name if device.kind == "cuda" else f"cpu {cpu_model()}"
    return re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")


def command_line(program, configuration, device, arguments):
    repeat, warmup = arguments.repeat, arguments.warmup
    if configuration.repeat:
        repeat, warmup = configuration.repeat, configuration.warmup
    return [str(program), *shlex.split(configuration.arguments),
            "--device", configuration.device or device.choice,
            "--repeat", str(repeat), "--warmup", str(warmup),
            "--output", configuration.image or "image.ppm", "--csv", "row.csv", "--quiet"]


def measure(command, timeout_s):
    """(status, message, row of ptexp's CSV). Refused: ptexp took offence at an option, or at what
    the option needs. Anything else that is not success ends the experiment."""
    with tempfile.TemporaryDirectory(prefix="ptexp-") as folder:
        try:
            run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False,
                                 stdin=subprocess.DEVNULL, timeout=timeout_s)
        except subprocess.TimeoutExpired:
            raise HarnessError(f"no end after {timeout_s:g} s (--timeout): "
                               f"{shlex.join(command)}") from None
        message = run.stderr.strip().removeprefix("ptexp: error: ")
        if run.returncode == 2 and not message.startswith("CUDA:"):
            return "refused", message, {}
        if run.returncode != 0:
            raise HarnessError(f"exit code {run.returncode}: {shlex.join(command)}: {message}")
        with open(Path(folder, "row.csv"), newline="", encoding="utf-8") as file:
            row, = csv.DictReader(file)
        return "measured", "", row


def measure_all(experiment, configurations, program, device, arguments):
    """A row for every configuration: name, status, message, labels, then ptexp's own columns."""
    rows, columns = [], []
    for number, configuration in enumerate(configurations, 1):
        command = command_line(program, configuration, device, arguments)
        status, message, measured = measure(command, arguments.timeout)
        columns = columns or list(measured)
        clash = set(configuration.labels) & {*measured, "name", "status", "message"}
        if clash:
            raise HarnessError(f"ptexp's CSV has columns {sorted(clash)} already")
        rows.append({"experiment": experiment.name, "name": configuration.name, "status": status,
                     "message": message, **configuration.labels, **measured})
        result = f"{float(measured['kernel_ms_median']):.4g} ms" if measured else message
        print(f"{number}/{len(configurations)}  {configuration.name}: {result}", flush=True)
    if not columns:
        raise HarnessError(f"ptexp refused every configuration, the first with: "
                           f"{rows[0]['message']}")
    for row in rows:
        row.update({column: "" for column in columns if column not in row})
    return rows


def csv_text(rows):
    columns = list(dict.fromkeys(column for row in rows for column in row))
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def provenance(experiment, program, device, arguments):
    """Where a table comes from, whatever was measured."""
    return {
        "experiment": experiment.name,
        "question": experiment.question,
        "command": shlex.join(["python3", *sys.argv]),
        "date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
        "quick": arguments.quick,
        "program": output_of(program, "--version").splitlines(),
        "device": asdict(device),
        "gpus": output_of("nvidia-smi", "--query-gpu=name,driver_version,clocks.max.sm,"
                          "clocks.max.mem,power.limit", "--format=csv").splitlines(),
        "host": {"cpu": cpu_model(), "cores": os.cpu_count(), "system": system_name(),
                 "python": platform.python_version()},
    }


def origin(experiment, configurations, program, device, arguments):
    """The same with all command lines: enough to measure it again."""
    return {
        **provenance(experiment, program, device, arguments),
        "plot": asdict(experiment.plot),
        "configurations": {
            c.name: shlex.join(["ptexp", *command_line(program, c, device, arguments)[1:]])
            for c in configurations},
    }


def write_atomically(path, text):
    """Whoever reads the path sees the old file or the whole new one."""
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}-", suffix=".tmp")
    try:
        with open(handle, "w", encoding="utf-8", newline="") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise


def table_path(experiment, device, arguments):
    """The table's file; its folder is made now, not after the measurement."""
    folder = arguments.output / device_folder(device)
    folder.mkdir(parents=True, exist_ok=True)
    return folder / f"{experiment.name}{'-' if arguments.label else ''}{arguments.label}.csv"


def write_table(path, rows, facts):
    write_atomically(path.with_suffix(".json"), json.dumps(facts, indent=2) + "\n")
    write_atomically(path, csv_text(rows))


def table_text(rows, labels):
    def number(row, column):
        return f"{float(row[column]):.4g}" if row[column] else ""
    lines = [["", "median ms", "min ms", "max ms", "Mpaths/s", *labels]]
    for row in rows:
        if row["status"] == "measured":
            times = [number(row, f"kernel_ms_{part}") for part in ("median", "min", "max")]
            lines.append([row["name"], *times, number(row, "mpaths_per_s"),
                          *(str(row.get(label, "")) for label in labels)])
        else:
            lines.append([row["name"], row["status"], "", "", "", *[""] * len(labels)])
    widths = [max(map(len, column)) for column in zip(*lines)]
    return "\n".join("  ".join([line[0].ljust(widths[0]),
                                *(text.rjust(w) for text, w in zip(line[1:], widths[1:]))]).rstrip()
                     for line in lines)


def draw(path):
    """Draws the table if it can: the numbers are safe by now."""
    try:
        import plot  # pylint: disable=import-outside-toplevel
    except ImportError as error:
        return f"no plot: {error}; experiments/README.md says how to install matplotlib"
    return f"wrote {plot.draw(path)}"


def parse_arguments(experiment, command):
    parser = argparse.ArgumentParser(description=experiment.question)
    add = parser.add_argument
    add("--ptexp", metavar="FILE", default="",
        help=f"the program [$PTEXP, else {' or '.join(PROGRAMS)}]")
    add("--device", metavar="auto|cpu|cuda[:N]", default="auto",
        help="auto: the first GPU if there is one, else the CPU [%(default)s]")
    add("--repeat", metavar="N", type=int, default=10,
        help="measured renders of a configuration [%(default)s]")
    add("--warmup", metavar="N", type=int, default=3, help="renders before them [%(default)s]")
    add("--quick", action="store_true",
        help="small images, to see that everything works; labelled 'quick' unless --label is given")
    add("--label", metavar="TEXT", default="",
        help="appended to the files' names, e.g. fast-math for a program built so")
    add("--output", metavar="DIR", type=Path, default=ROOT / "results",
        help="the files are DIR/DEVICE/NAME.csv, .json and .png [results/ of the repository]")
    add("--timeout", metavar="S", type=float, default=3600,
        help="seconds for one configuration [%(default)s]")
    add("--list", action="store_true", help="print the command lines and run nothing")
    experiment.add_arguments(parser)
    arguments = parser.parse_args(command)
    if arguments.repeat < 1 or arguments.warmup < 0:
        parser.error("expected --repeat of 1 or more and --warmup of 0 or more")
    if not re.fullmatch(r"[\w.-]*", arguments.label):
        parser.error(f"--label {arguments.label}: expected letters, digits and any of _ . -")
    if arguments.quick and not arguments.label:
        arguments.label = "quick"
    return arguments


def run(experiment, arguments):
    program = find_program(arguments.ptexp)
    device = find_device(program, arguments.device)
    configurations = experiment.configurations(arguments, device)
    names = [configuration.name for configuration in configurations]
    if len(set(names)) < len(names):
        raise HarnessError(f"{experiment.name}: two configurations have one name")
    if arguments.list:
        for configuration in configurations:
            print(shlex.join(command_line(program, configuration, device, arguments)))
        return
    print(f"{experiment.question}\non {device.choice}: {device.name} ({device.detail})", flush=True)
    path = table_path(experiment, device, arguments)
    experiment.check(program, device, arguments)
    rows = measure_all(experiment, configurations, program, device, arguments)
    measured = [row for row in rows if row["status"] == "measured"]
    experiment.finish(measured, arguments)
    facts = origin(experiment, configurations, program, device, arguments)
    facts["conclusions"] = experiment.conclude(measured, arguments)

    write_table(path, rows, facts)
    print("\n".join(["", table_text(rows, experiment.table), "", *facts["conclusions"],
                     f"wrote {path}", draw(path)]))


def main(experiment, command=None, runner=run):
    """Runs the experiment as the command line says; returns the exit code. `runner`, called with
    the experiment and the arguments, measures and writes the table."""
    arguments = parse_arguments(experiment, command)
    try:
        runner(experiment, arguments)
    except BrokenPipeError:  # whoever read the output has gone
        sys.stdout = None
        return 1
    except (HarnessError, OSError) as error:
        print(f"{experiment.name}: error: {error}; no result was written", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print(f"{experiment.name}: interrupted; no result was written", file=sys.stderr)
        return 130
    return 0
