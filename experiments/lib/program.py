"""Finds ptexp and its devices, and runs it."""
import csv
import hashlib
import json
import os
import re
import shlex
import subprocess
import tempfile
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


def command_line(program, configuration, device, repeat, warmup):
    return [*shlex.split(configuration.launcher), configuration.program or str(program), *shlex.split(configuration.arguments),
            "--device", configuration.device or device.choice,
            "--repeat", str(repeat), "--warmup", str(warmup),
            "--output", configuration.image or "image.ppm",
            "--csv", "row.csv", "--stats", "run.json", "--quiet"]


@dataclass
class Process:
    """What a process of ptexp has left."""
    status: str  # measured, refused or failed
    message: str = ""  # why not measured
    row: dict = field(default_factory=dict)  # of ptexp's CSV
    runs: list = field(default_factory=list)  # for each repeat kernel_ms, wall_ms, {stage: ms}, devices


def code_text(code):
    return f"exit code {code}" if code > 0 else f"ended by signal {-code}"


def measure(command, timeout_s):
    """Refused: ptexp took offence at an option, or at what the option needs. Whatever else is not
    success is a failure."""
    with tempfile.TemporaryDirectory(prefix="ptexp-") as folder:
        try:
            run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False,
                                 stdin=subprocess.DEVNULL, timeout=timeout_s)
        except subprocess.TimeoutExpired:
            return Process("failed", f"no end after {timeout_s:g} s (--timeout)")
        message = " ".join(run.stderr.split()).removeprefix("ptexp: error: ")
        if run.returncode == 2 and not message.startswith("CUDA:"):
            return Process("refused", message)
        if run.returncode == 130:  # Ctrl-C has reached ptexp first
            raise KeyboardInterrupt
        if run.returncode != 0:
            return Process("failed", ": ".join(filter(None, [code_text(run.returncode), message])))
        with open(Path(folder, "row.csv"), newline="", encoding="utf-8") as file:
            row, = csv.DictReader(file)
        facts = json.loads(Path(folder, "run.json").read_text(encoding="utf-8"))
        return Process("measured", row=row, runs=[
            {"kernel_ms": run["kernel_ms"], "wall_ms": run.get("wall_ms"),
             "devices": run.get("devices", []),
             "stages": {stage["stage"]: stage["time_ms"] for stage in run["stages"]}}
            for run in facts["runs"]])
