"""Stands for ptexp in tests of the harness: it takes its times from the file `behaviour.json`
beside it and writes what it was asked for into the file `log` there.

behaviour.json: {"version": text, "times": {seed: [ms]}, "images": {seed: text}, "wrong": {seed:
exit code}, "kills": n, "process": {part: ms}, "end_s": s, "dies": {seed: signal}, "hangs": [seed],
"answers": {seed: text}, "factor": x, "help": text}; kills: it kills the harness when it is to render number n;
process: what it says of its wall time; end_s: how long it sleeps after its files; answers: what
`measure` says instead; factor: by which its times are multiplied.
"""
import json
import os
import sys
import time

HERE = os.path.dirname(sys.argv[0])


def read(*path):
    with open(os.path.join(*path), encoding="utf-8") as file:
        return file.read()


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


BEHAVIOUR = json.loads(read(HERE, "behaviour.json"))  # modules that load slowly are left out here
COLUMNS = ["seed", "kernel_ms_median", "kernel_ms_min", "kernel_ms_max", "serial_ms_median",
           "serial_ms_min", "serial_ms_max", "mpaths_per_s", "paths", "rays", "shadow_rays",
           "scene_ms", "repeat"]


class Wrong(Exception):
    """(message, exit code)"""


def option(name, default=""):
    return sys.argv[sys.argv.index(name) + 1] if name in sys.argv else default


def compare(first, second):
    differ = read(first) != read(second)
    print(f"differing pixels       {3 if differ else 0}")
    sys.exit(int(differ))


def render(is_measured):
    """(row of the CSV, statistics); none of an image alone."""
    seed = option("--seed")
    with open(os.path.join(HERE, "log"), "a+", encoding="utf-8") as log:
        log.seek(0)
        number = log.read().count("measure")
        if is_measured and number == BEHAVIOUR.get("kills"):
            os.kill(os.getppid(), 9)
            sys.exit(9)
        print("measure" if is_measured else "check", seed, option("--repeat"), option("--width"),
              os.getpid(), file=log)
    if seed in BEHAVIOUR.get("dies", {}):
        os.kill(os.getpid(), BEHAVIOUR["dies"][seed])
    if seed in BEHAVIOUR.get("hangs", []):
        time.sleep(60)
    code = BEHAVIOUR.get("wrong", {}).get(seed, 0)
    if code:
        raise Wrong(f"seed {seed} is wrong", code)
    if "--output" in sys.argv:
        write(option("--output"), BEHAVIOUR.get("images", {}).get(seed, "same"))
    if not is_measured:
        return {}, {}
    factor = BEHAVIOUR.get("factor", 1) if "--csv" not in sys.argv else 1
    times = [factor * time for time in BEHAVIOUR.get("times", {}).get(seed, [1.0])]
    return measured([times[i % len(times)] for i in range(int(option("--repeat")))], seed)


def measured(times, seed):
    row = dict.fromkeys(COLUMNS, "1")
    row.update(seed=seed, paths="1000", rays="3000", shadow_rays="1000")
    parts = BEHAVIOUR.get("process", {})
    row.update((f"process_{part}_ms", str(ms)) for part, ms in parts.items())
    wall = float(os.environ.get("PTEXP_FAKE_WALL", "0"))  # as multiple of the kernel time
    runs = [{"kernel_ms": time, "stages": [{"stage": "serial", "time_ms": time / 2}]}
            for time in times]
    for number, run in enumerate(runs if wall else []):
        devices = BEHAVIOUR["devices"][number % len(BEHAVIOUR["devices"])]
        run.update(wall_ms=wall * run["kernel_ms"], devices=[
            {"units": 3 + place, "kernel_ms": time} for place, time in enumerate(devices)])
    return row, {"runs": runs}


def render_alone():
    is_measured = "--csv" in sys.argv
    try:
        row, statistics = render(is_measured)
    except Wrong as wrong:
        print(f"ptexp: error: {wrong.args[0]}", file=sys.stderr)
        sys.exit(wrong.args[1])
    if is_measured:
        write(option("--csv"), ",".join(row) + "\n" + ",".join(row.values()) + "\n")
        write(option("--stats"), json.dumps(statistics))
        time.sleep(BEHAVIOUR.get("end_s", 0))


def answer():
    """To a line of `measure`."""
    try:
        row, statistics = render(True)
    except Wrong as wrong:
        message, code = wrong.args
        if code != 2:  # as a crash
            print(f"ptexp: error: {message}", file=sys.stderr)
            sys.exit(code)
        return json.dumps({"error": message, "exit_code": code})
    text = json.dumps({"row": row, "statistics": statistics})
    return BEHAVIOUR.get("answers", {}).get(option("--seed"), text)


def resident():
    for line in sys.stdin:
        sys.argv[1:] = json.loads(line)["arguments"]
        print(answer(), flush=True)


if sys.argv[1] == "--list-devices":
    print("cpu        CPU (2 threads)")
elif sys.argv[1] == "--version":
    print(f"ptexp 0\ncommit {BEHAVIOUR.get('version', 'abc')}")
elif sys.argv[1] == "--help-all":
    print(BEHAVIOUR.get("help", ""))
elif sys.argv[1] == "compare":
    compare(*sys.argv[2:4])
elif sys.argv[1] == "measure":
    resident()
else:
    render_alone()
