"""Finds ptexp and its devices, and runs it."""
import csv
import functools
import hashlib
import json
import os
import re
import shlex
import subprocess
import tempfile
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path

from lib.description import Device, HarnessError, Refused

ROOT = Path(__file__).resolve().parents[2]
PROGRAMS = ["build/release/src/ptexp", "install/bin/ptexp"]  # below ROOT, unless named


COUNTS_LANES = "divergence counters"  # in --version of a build with PTEXP_DIVERGENCE


def find_program(named, counts_lanes=False):
    """The path of ptexp: --ptexp, else $PTEXP, else what was built or installed here. A build that
    counts lanes is an error unless one is asked for, for its times tell nothing."""
    named = named or os.environ.get("PTEXP")
    candidates = [Path(named)] if named else [ROOT / path for path in PROGRAMS]
    for path in candidates:
        if path.is_file() and os.access(path, os.X_OK):
            if (COUNTS_LANES in output_of(path, "--version")) != counts_lanes:
                raise HarnessError(f"{path}: expected a build with PTEXP_DIVERGENCE=ON"
                                   if counts_lanes else
                                   f"{path}: has {COUNTS_LANES}; expected a build without, for the "
                                   "times of this one tell nothing")
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


def version_of(program):
    """What --version prints; where that names no commit for sure, also a hash of the program."""
    text = output_of(program, "--version")
    if "-dirty" in text or "commit" not in text:
        text += f"\nsha256 {hashlib.sha256(Path(program).read_bytes()).hexdigest()[:16]}"
    return text


def run_ptexp(program, *arguments, timeout_s=None):
    """What ptexp prints. 1 is no failure: `compare` has found a difference."""
    try:
        run = subprocess.run([program, *arguments], capture_output=True, text=True, check=False,
                             stdin=subprocess.DEVNULL, timeout=timeout_s)
    except subprocess.TimeoutExpired:
        raise HarnessError(f"no end after {timeout_s:g} s (--timeout)") from None
    if run.returncode not in (0, 1):
        message = run.stderr.strip()
        kind = Refused if run.returncode == 2 and "CUDA:" not in message else HarnessError
        raise kind(f"{shlex.join(map(str, arguments))}: {message or code_text(run.returncode)}")
    return run.stdout


def failure_of(program, command, timeout_s):
    """Runs ptexp: None, or what went wrong."""
    try:
        run = subprocess.run([str(program), *command], capture_output=True, text=True, check=False,
                             stdin=subprocess.DEVNULL, timeout=timeout_s)
    except subprocess.TimeoutExpired:
        return f"no end after {timeout_s:g} s (--timeout)"
    if run.returncode == 130:  # Ctrl-C has reached ptexp first
        raise KeyboardInterrupt
    return f"exit code {run.returncode}: {run.stderr.strip()}" if run.returncode else None


def devices_of(program):
    lines = re.findall(r"(?m)^(\S+)\s+(.*) \((.*)\)$", output_of(program, "--list-devices"))
    gpus = sum(choice.startswith("cuda") for choice, _, _ in lines)
    return [Device(*line, gpus) for line in lines]


def find_device(program, wanted):
    """The device that --device names; auto: the first GPU if there is one, else the CPU."""
    devices = devices_of(program)
    order = sorted(devices, key=lambda device: device.kind != "cuda")
    for device in order:
        if wanted in ("auto", device.choice, device.kind):
            return device
    raise HarnessError(f"--device {wanted}: {program} lists "
                       f"{', '.join(device.choice for device in devices) or 'no device'}")


def check_gpu(experiment, device):
    """An experiment that measures nothing on a CPU says so before it begins."""
    if experiment.needs_gpu and device.kind != "cuda":
        raise HarnessError(f"needs a GPU, and --device {device.choice} is a CPU: expected cuda or "
                           "cuda:N")


@functools.lru_cache(maxsize=None)
def has_calibrations(program):
    return "--calibration" in output_of(program, "--help-all")


def words_of(program, configuration, device, repeat, warmup):
    """ptexp's arguments but for files. What the user's cache folder has decides nothing unasked."""
    words = [*shlex.split(configuration.arguments), "--device", configuration.device or device.choice,
             "--repeat", str(repeat), "--warmup", str(warmup), "--quiet"]
    if has_calibrations(configuration.program or str(program)) and "--calibration" not in words:
        words += ["--calibration", device.calibration]
    return words


def command_line(program, configuration, device, repeat, warmup):
    command = [*shlex.split(configuration.launcher), configuration.program or str(program)]
    if not configuration.renders:
        return [*command, *shlex.split(configuration.arguments)]
    return [*command, *words_of(program, configuration, device, repeat, warmup),
            "--output", configuration.image or "image.ppm", "--csv", "row.csv", "--stats", "run.json"]


@dataclass
class Process:
    """What a process of ptexp has left."""
    status: str  # measured, refused or failed
    message: str = ""  # why not measured
    row: dict = field(default_factory=dict)  # of ptexp's CSV
    runs: list = field(default_factory=list)  # for each repeat kernel_ms, wall_ms, {stage: ms}, devices
    wall_ms: float = 0  # from fork to exit
    early_ms: float = 0  # /proc/PID/stat, where ptexp reads its age, has the fork so much too early


def code_text(code):
    return f"exit code {code}" if code > 0 else f"ended by signal {-code}"


def early_ms_of(pid, begin_s):
    """By how much the process began before `begin_s` of CLOCK_BOOTTIME, says /proc: 0 to 10 ms, for
    it counts ticks of 10 ms."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
        return 1e3 * (begin_s - int(fields[19]) / os.sysconf("SC_CLK_TCK"))
    except OSError:
        return 0.0


def run_timed(command, folder, errors, timeout_s):
    """(exit code, None after the timeout; wall time from fork to exit in ms; early_ms)"""
    late = threading.Event()
    begin_s, begin_boot_s = time.perf_counter(), time.clock_gettime(time.CLOCK_BOOTTIME)
    with subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                          stderr=errors) as process:
        def end():
            late.set()
            process.kill()
        # wait(timeout) would ask every 50 ms only.
        timer = threading.Timer(timeout_s, end)
        timer.start()
        try:
            early_ms = early_ms_of(process.pid, begin_boot_s)
            code = process.wait()
            wall_ms = 1e3 * (time.perf_counter() - begin_s)
        except BaseException:
            process.kill()
            raise
        finally:
            timer.cancel()
    return None if late.is_set() else code, wall_ms, early_ms


def one_line(message):
    return " ".join(message.split()).removeprefix("ptexp: error: ")


def failed_or_refused(code, message):
    """Of a process that has not measured. Refused: ptexp took offence at an option, or at what the
    option needs. Whatever else is not success is a failure."""
    if code == 130:  # Ctrl-C has reached ptexp first
        raise KeyboardInterrupt
    if code == 2 and not message.startswith("CUDA:"):
        return Process("refused", message)
    return Process("failed", ": ".join(filter(None, [code_text(code) if code else "", message])))


def process_of(row, statistics, wall_ms, early_ms=0.0):
    """Of one that has, by its row of the CSV and what --stats writes."""
    return Process("measured", row=row, wall_ms=wall_ms, early_ms=early_ms, runs=[
        {"kernel_ms": run["kernel_ms"], "wall_ms": run.get("wall_ms"),
         "devices": run.get("devices", []),
         "stages": {stage["stage"]: stage["time_ms"] for stage in run["stages"]}}
        for run in statistics["runs"]])


def measure(command, timeout_s, renders=True):
    """Runs ptexp as a process of its own."""
    with tempfile.TemporaryDirectory(prefix="ptexp-") as folder:
        errors = Path(folder, "errors")
        with open(errors, "wb") as file:
            code, wall_ms, early_ms = run_timed(command, folder, file, timeout_s)
        if code is None:
            return Process("failed", f"no end after {timeout_s:g} s (--timeout)")
        if code != 0:
            text = errors.read_text(encoding="utf-8", errors="replace")
            return failed_or_refused(code, one_line(text))
        if not renders:
            return Process("measured", wall_ms=wall_ms, early_ms=early_ms)
        with open(Path(folder, "row.csv"), newline="", encoding="utf-8") as file:
            row, = csv.DictReader(file)
        facts = json.loads(Path(folder, "run.json").read_text(encoding="utf-8"))
        return process_of(row, facts, wall_ms, early_ms)
