#!/usr/bin/env python3
"""GPU size: how does each mode scale with the GPU's multiprocessors, and does the faster one change?

--sms N renders on N multiprocessors of the GPU. `speed_*` is millions of paths per second and
multiprocessor: a flat line is a mode that scales, a falling one an image that no longer fills the
GPU, or memory that all share. `ratio_*` is the megakernel's time divided by the row's, on as many
multiprocessors. Memory and L2 cache stay those of the whole GPU, so that a multiprocessor of a
small part has more of both than that of a small GPU: what is bound by memory looks better here.
Rows with `block_kib` plan for blocks of so much shared memory, as a smaller GPU has them.
"""
import shlex
import sys

from lib import harness
from lib.harness import Configuration, Experiment, Plot
from lib.kernels import multiprocessors_of
from lib.ratios import ratio_labels, set_ratios
from lib.scene_files import add_scene_files, scene_files, short_name
from lib.sentences import in_groups, listed, relation, show, time_of

BASE = "megakernel"
MODES = [BASE, "wavefront"]
SIZES = [8, 16, 32, 64]  # multiprocessors, and all
BLOCK_KIB, BLOCK_SMS = 64, 32  # a small GPU of a generation with small blocks
# One tree for all sizes, which --builder auto would choose by the time that rendering takes.
SCENES = {"spheres": "--scene spheres --max-depth 50",
          "cornell": "--scene cornell --max-depth 8",
          "statue:1M": "--scene statue:1M --builder hploc --max-depth 8",
          "dial:16:0:closed": "--scene dial:16:0:closed --max-depth 8",
          "fog": "--scene fog --max-depth 8"}
IMAGES = {256: 16, 1024: 4}  # {width and height: samples}
QUICK = {"spheres": SCENES["spheres"], "statue:1K": "--scene statue:1K --max-depth 8"}
SPEEDS = {"median": "median", "min": "max", "max": "min", "low": "high", "high": "low"}


def add_arguments(parser):
    add_scene_files(parser)
    parser.add_argument("--sms", nargs="+", type=int, metavar="N", default=SIZES,
                        help="multiprocessors, besides all [%(default)s]")
    parser.set_defaults(repeat=5, rounds=1, warmup=1)


def sizes_of(arguments, device):
    """[(multiprocessors, KiB of a block or 0, options)], the whole GPU last."""
    whole = multiprocessors_of(getattr(device, "detail", ""))
    parts = [sms for sms in arguments.sms if not whole or sms < whole]
    sizes = [(sms, 0, f"--sms {sms}") for sms in (parts[:1] if arguments.quick else parts)]
    if not arguments.quick and BLOCK_SMS in parts:
        sizes.append((BLOCK_SMS, BLOCK_KIB, f"--sms {BLOCK_SMS} --shared-memory-max {BLOCK_KIB}"))
    return sizes + [(whole, 0, "")]


def scenes_of(arguments):
    if arguments.quick:
        return QUICK
    return {**SCENES, **{short_name(path): f"--scene {shlex.quote(path)} --max-depth 8"
                         for path in scene_files(arguments)}}


def configurations(arguments, device):
    sizes = sizes_of(arguments, device)
    images = {16: 2} if arguments.quick else IMAGES
    rows = []
    for scene, options in scenes_of(arguments).items():
        for width, samples in images.items():
            panel = f"{scene}, {width}x{width}"
            for mode in MODES:
                for sms, kib, size in sizes:
                    name = f"{panel}: {mode} on {sms or 'all'}" + (f", {kib} KiB" if kib else "")
                    is_end = sms in (sizes[0][0], sizes[-1][0]) or kib
                    rows.append(Configuration(
                        name, f"--mode {mode} {options} --width {width} --height {width} "
                        f"--spp {samples} {size}".strip(),
                        {"panel": panel, "series": mode, "x": "" if kib else sms, "variant": mode,
                         "multiprocessors": sms, "block_kib": kib or "",
                         **{f"speed_{part}": "" for part in SPEEDS}, **ratio_labels()},
                        same_image=scene if is_end else ""))
    return rows


def size_of(row):
    return row["panel"], row["multiprocessors"], row["block_kib"]


def finish(rows, _arguments):
    set_ratios(rows, BASE, size_of)
    for row in rows:
        for part, time in SPEEDS.items():
            seconds = float(row[f"kernel_ms_{time}"]) * 1e-3
            row[f"speed_{part}"] = (
                f"{1e-6 * int(row['paths']) / seconds / max(int(row['multiprocessors']), 1):.6g}")


def winner(pair):
    """(which of two rows of one size is faster, by how much)"""
    mega, wave = (time_of(pair[mode]) for mode in MODES)
    if relation(mega, wave) == "overlap":
        return "neither", 1.0
    ratio = mega.middle / wave.middle
    return ("wavefront", ratio) if ratio > 1 else (BASE, 1 / ratio)


def winners(pairs):
    """'the wavefront on 8 and 16 (at most 1.20 times), neither on 32': ascending sizes."""
    runs = []
    for sms, pair in pairs:
        name, factor = winner(pair)
        if not runs or runs[-1][0] != name:
            runs.append((name, [], []))
        runs[-1][1].append(sms)
        runs[-1][2].append(factor)
    texts = []
    for name, sizes, factors in runs:
        text = f"{name if name == 'neither' else 'the ' + name} on {listed(map(str, sizes))}"
        texts.append(text if name == "neither" else f"{text} (at most {show(max(factors))} times)")
    return ", ".join(texts)


def conclude(rows, _arguments):
    lines = []
    for panel, mine in in_groups(rows, "panel").items():
        sizes, planned = {}, {}
        for row in mine:
            group = planned if row["block_kib"] else sizes
            group.setdefault(int(row["multiprocessors"]), {})[row["variant"]] = row
        pairs = sorted((sms, pair) for sms, pair in sizes.items() if len(pair) == len(MODES))
        if not pairs:
            continue
        lines.append(f"{panel}: faster is {winners(pairs)}")
        (least, first), (most, last) = pairs[0], pairs[-1]
        if most > least:
            gains = {mode: time_of(first[mode]).middle / time_of(last[mode]).middle for mode in MODES}
            lines.append(f"{panel}: {show(most / least)} times the multiprocessors are " + " and ".join(
                f"{show(gain)} times as fast in the {mode}" for mode, gain in gains.items()))
        for sms, pair in planned.items():
            if len(pair) == len(MODES):
                name, factor = winner(pair)
                how = f"the {name}, {show(factor)} times" if name != "neither" else name
                lines.append(f"{panel}, {sms} multiprocessors and blocks of {BLOCK_KIB} KiB: faster "
                             f"is {how}")
    return lines


EXPERIMENT = Experiment(
    "gpu_size", __doc__.splitlines()[0], configurations,
    Plot("lines", "Speed of each multiprocessor, on parts of one GPU (memory and L2 cache whole)",
         "multiprocessors", "million paths per second and multiprocessor", y="speed", log_y=False),
    add_arguments=add_arguments, finish=finish, conclude=conclude, needs_gpu=True,
    table=("speed_median", "ratio_median"))

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
