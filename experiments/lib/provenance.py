"""Where a table comes from: program, device, host, the GPU's state, the scene's files."""
import contextlib
import datetime
import functools
import hashlib
import os
import platform
import re
import shlex
import sys
from dataclasses import asdict
from pathlib import Path

from lib.program import output_of, version_of

GPU = "name,driver_version,clocks.max.sm,clocks.max.mem,power.limit"
GPU_NOW = "index,clocks.sm,clocks.mem,temperature.gpu,power.draw"
SLOWED_BY = ["clocks_event_reasons.active", "clocks_throttle_reasons.active"]  # new and old name
HASHED_BYTES = 1 << 28  # of a scene's folder; of what lies beyond, the sizes


def now():
    return datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds")


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
    """E.g. nvidia-h200, nvidia-h200-x2 for two of them, or cpu-amd-epyc-9654: a folder's results
    come from one kind of machine."""
    name = device.name if device.kind == "cuda" else f"cpu {cpu_model()}"
    if device.kind == "cuda" and device.gpus > 1:
        name += f" x{device.gpus}"
    return re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")


def nvidia_smi(query):
    return output_of("nvidia-smi", f"--query-gpu={query}", "--format=csv").splitlines()


def machine_state():
    """What a round can differ in: clocks, temperature, power, why clocks are low, the load."""
    gpus = next(filter(None, (nvidia_smi(f"{GPU_NOW},{name}") for name in SLOWED_BY)), [])
    return {"date": now(), "gpus": gpus, "load": os.getloadavg()[0]}


def files_beside(scene):
    """The scene's file and those beside and below it, which it may refer to; those that others remove
    meanwhile are none of it."""
    found = [Path(folder, name) for folder, _, names in os.walk(Path(scene).parent) for name in names]
    return sorted(path for path in found if path.is_file())


@functools.lru_cache(maxsize=None)
def folder_hash(scene):
    """Of the scene's name and of the files beside it."""
    digest, left = hashlib.sha256(f"{scene.name}\n".encode()), HASHED_BYTES
    for path in files_beside(scene):
        size, content = 0, "?"
        with contextlib.suppress(OSError):
            size = path.stat().st_size
            if left >= size:
                content = hashlib.sha256(path.read_bytes()).hexdigest()
        left -= size
        digest.update(f"{path.relative_to(scene.parent)}\n{size}\n{content}\n".encode())
    return digest.hexdigest()[:16]


def scene_hash(arguments):
    """Of the scene that ptexp's arguments name: sha256 over its folder's files, a scene of ptexp's
    own by its name (the commit says what it is)."""
    tokens = shlex.split(arguments)
    scene = tokens[tokens.index("--scene") + 1] if "--scene" in tokens else "spheres"
    if not Path(scene).is_file():
        return f"built-in {scene}"
    return f"sha256 {folder_hash(Path(scene))}"


def provenance(experiment, program, device, arguments):
    """Where a table comes from, whatever was measured."""
    return {
        "experiment": experiment.name,
        "question": experiment.question,
        "command": shlex.join(["python3", *sys.argv]),
        "date": now(),
        "quick": arguments.quick,
        "program": version_of(program).splitlines(),
        "device": asdict(device),
        "gpus": nvidia_smi(GPU),
        "host": {"cpu": cpu_model(), "cores": os.cpu_count(),
                 "system": system_name(), "python": platform.python_version()},
    }
