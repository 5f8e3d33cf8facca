"""Which numbers of README.md, results/README.md and others come from which rows of the tables.

A Place is a piece of a page's text with a slot, as of str.format, for each number; a space stands for
any white space. A Claim is a sentence that is true of some tables only. scripts/page_numbers checks
both and writes the numbers.
"""
import csv
import datetime
import json
import re
import subprocess
import sys
from dataclasses import dataclass
from functools import lru_cache, partial
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RESULTS = ROOT / "results"
DEVICE = "nvidia-h200"
MAIN, TABLES = "README.md", "results/README.md"


class NumberError(Exception):
    """A table lacks what a page says."""


@dataclass
class Place:
    page: str
    text: str
    values: list  # of functions, one for each slot


@dataclass
class Claim:
    page: str
    text: str
    holds: object  # a function


@lru_cache(maxsize=None)
def rows_of(table):
    is_beside = "mitsuba" in table or "/" in table
    path = RESULTS / (f"{table}.csv" if is_beside else f"{DEVICE}/{table}.csv")
    if not path.is_file():
        raise NumberError(f"{path} is missing")
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def row_of(table, **labels):
    found = [row for row in rows_of(table) if all(row.get(key) == value for key, value in labels.items())]
    if len(found) != 1:
        raise NumberError(f"{table}.csv has {len(found)} rows with {labels}; expected one")
    return found[0]


def cell(table, name, column="kernel_ms_median", factor=1):
    return lambda: factor * float(row_of(table, name=name)[column])


def by(table, column, **labels):
    return lambda: float(row_of(table, **labels)[column])


def over(first, second):
    return lambda: first() / second()


def defaults(scene, mode, column="kernel_ms_median"):
    return cell("defaults", f"{scene}: {mode}", column)


def both_modes(scene):
    return [defaults(scene, mode, column) for mode in ("megakernel", "wavefront")
            for column in ("mpaths_per_s", "kernel_ms_median")]


def target(mode, image, samples):
    return cell("speed_targets", f"{mode}, {image}, {samples} samples, depth 50")


def serial(size):
    return cell("image_size", f"serial, CPU {size}", "image_ms_median", 1e-3)


def facts(table):
    return json.loads((RESULTS / DEVICE / f"{table}.json").read_text(encoding="utf-8"))


def commits(tables):
    return sorted({line.split()[1][:8] for table in tables for line in facts(table)["program"]
                   if line.startswith("commit ")})


def of_one_run():
    """What the folder of the device holds, in words."""
    tables = sorted(path.stem for path in (RESULTS / DEVICE).glob("*.json"))
    days = sorted(facts(table)["date"][:10] for table in tables)
    first, last = (datetime.date.fromisoformat(days[end]) for end in (0, -1))
    day = f"{last.day} {last:%B}"
    if len(commits(tables)) == 1:
        return f"all by `scripts/reproduce`, commit {commits(tables)[0]}, {day}"
    return f"{len(commits(tables))} commits, {first.day} {first:%B} to {day}"


@lru_cache(maxsize=None)
def minutes_of_reproduce():
    """By its own estimates, on one GPU."""
    done = subprocess.run([sys.executable, ROOT / "scripts" / "reproduce", "--list"], capture_output=True,
                          text=True, check=True)
    seconds = dict(re.findall(r"(?m)^(\w+) +(\d+) s", done.stdout))
    return (int(seconds["all"]) - int(seconds["scaling"])) / 60


def driver():
    return facts("defaults")["gpus"][1].split(", ")[1]


def toolkit():
    return rows_of("defaults")[0]["cuda"].partition(",")[0].rpartition(".")[0]


def ladder(scene):
    """Times of the ladder's steps by their names without the number."""
    return {row["x"].partition(" ")[2]: float(row["kernel_ms_median"]) if row["kernel_ms_median"]
            else None for row in rows_of("ladder") if row["panel"] == scene}


BALLS, STATUE, DIAL, HALL = "spheres", "statue:1M", "dial:16:0:closed", "modern-hall/scene.xml"
ROOM = "grey-white-room/scene.xml"
LADDER = [BALLS, STATUE, DIAL, HALL]
# What the page calls a step, the experiment's name of it, the columns that have it
STEPS = [
    ("megakernel, default options", "megakernel at its best", LADDER),
    ("megakernel, loop, binary tree |", "megakernel", LADDER[1:]),
    ("wavefront: one kernel per stage, no queues", "split kernels", LADDER),
    ("structure of arrays", "SoA instead of AoS", LADDER),
    ("compaction", "compaction", LADDER),
    ("surfaces sorted by material", "material order", LADDER),
    ("a ray's records in one sector", "whole rays in sectors", LADDER),
    ("regeneration", "regeneration", LADDER),
    ("CUDA graph", "CUDA graph", LADDER),
    ("last paths in one kernel", "last paths in one kernel", LADDER),
    ("pool of the whole batch", "pool of the whole batch", LADDER),
    ("wide tree, one thread per ray |", "wide tree", LADDER[1:]),
    ("persistent threads |", "persistent warps", LADDER[1:]),
    ("fused stages", "fused stages", [BALLS]),
    ("two rays per wave", "two rays a wave", [BALLS])]


def step(scene, name):
    """A step's time. The spheres' megakernel is at its best as it is."""
    times = ladder(scene)
    if name == "megakernel at its best" and name not in times:
        name = "megakernel"
    if name not in times:
        raise NumberError(f"ladder.csv has no step '{name}' of {scene}")
    return times[name]


def step_time(scene, name):
    return lambda: step(scene, name)


def step_text(scene, name):
    return lambda: f"{step(scene, name):.1f}" if step(scene, name) else "no such kernel"


def last(scene):
    return "two rays a wave" if scene == BALLS else "persistent warps"


def step_ratio(scene, above, below):
    return lambda: step(scene, above) / step(scene, below)


RAY_WAYS = [("bvh2", "threads"), ("cwbvh", "persistent"), ("cwbvh", "beam")]


def rates(name, kind):
    """Rays per second by each way."""
    return [float(row_of("ray_sets", ray_file=f"{name}.{kind}.rays", accel=accel, builder="sah",
                         variant=variant)["mrays_per_s"]) for accel, variant in RAY_WAYS]


def rate_texts(name, kind):
    def text(place):
        found = rates(name, kind)
        shown = f"{found[place]:,.0f}"
        return f"**{shown}**" if found[place] == max(found) else shown
    return [lambda place=place: text(place) for place in range(len(RAY_WAYS))]


def ray_rates(name):
    return [value for kind in ("primary", "ao", "diffuse") for value in rate_texts(name, kind)]


def fastest(kind):
    return {rates(name, kind).index(max(rates(name, kind))) for name in ("bunny_room", "statue1M")}


def loops():
    return [float(row["ratio_median"]) for row in rows_of("media") if row["variant"] == "loop"
            and row["status"] == "measured"]


def times_by_optix(hits):
    """Times of a wavefront that traces by OptiX over ours, of each scene."""
    return [1 / float(row["ratio_median"]) for row in rows_of("log/2026-11-optix-times") if row["variant"] == hits]


def least_by_optix(hits):
    return min(times_by_optix(hits))


def most_by_optix(hits):
    return max(times_by_optix(hits))


def unseen():
    """(works that the law predicts within 10 %, all) of families that it has not seen, in its range."""
    errors = [abs(float(row["error"])) for row in rows_of("law")
              if row["error"] and "outside" not in row["verdict"]]
    return sum(error <= 0.1 for error in errors), len(errors)


def metropolis(scene, series, place, column, spread=False):
    """Of the shortest (0) or the longest time (-1)."""
    def row():
        mine = [one for one in rows_of("metropolis") if one["panel"] == scene and one["series"] == series]
        if not mine:
            raise NumberError(f"metropolis.csv has no {series} of {scene}")
        return sorted(mine, key=lambda one: float(one["seconds"]))[place]

    def text():
        ends = [float(row()[f"{column}_{end}"]) for end in ("median", "low", "high")]
        return "{:.2f} [{:.2f}, {:.2f}]".format(*ends)
    return text if spread else lambda: row()[column] if column in ("seconds", "seeds") else float(
        row()[f"{column}_median"])


def gains(scene, spread):
    return [metropolis(scene, "mlt", place, "gain", spread) for place in (0, -1)] + [
        over(*(metropolis(scene, series, -1, measure) for series in ("path", "mlt")))
        for measure in ("rmse", "flip")]


def against_mitsuba(depth):
    def rate(**labels):
        return by("mitsuba_media", "msamples_per_s", optical_depth=depth, **labels)
    return over(rate(program="ptexp", variant="wavefront"), rate(program="mitsuba"))


def mitsuba_speed(program, variant):
    return [by("mitsuba_speed", "msamples_per_cpu_s", program=program, variant=variant, scene=scene)
            for scene in ("cornell-box", "modern-hall")]


def variance(way):
    return [by("mitsuba_variance", "relative_to_mitsuba", way=way, scene=scene)
            for scene in ("cornell-box", "grey-white-room", "modern-hall")]


PAPER = "spheres 600x300"
SCENES = [("Cornell box (quads, brute force) | |", "cornell"), ("`boxes` | 6 k |", "boxes"),
          ("`statue:1M` | 1 M |", STATUE), ("`terrain:1M` | 1 M |", "terrain:1M"),
          ("`instances:10K` | |", "instances:10K"), ("`instances:1M` | |", "instances:1M"),
          ("`dial:16:0:closed` | 49 k |", DIAL), ("Modern Hall, with its medium | 32 k |", HALL),
          ("Grey & White Room | 143 k |", ROOM)]
RATES = " | {:,.0f} | {:.1f} | {:,.0f} | {:.1f}"


def best_of_size(mode):
    return cell("image_size", f"{mode}, CUDA 2400x1200", "image_ms_median")


PLACES = [
    *(Place(page, text, [minutes_of_reproduce]) for page, text in (
        (MAIN, "scripts/reproduce # {:.0f} minutes on one H200"),
        ("experiments/README.md", "some {:.0f} minutes on one"),
        ("scripts/reproduce", "On one H200 this takes some {:.0f} minutes"))),
    Place(MAIN, "the paper's image (600x300, 50 samples: 9 million paths) takes the megakernel {:.1f} ms and "
          "the wavefront {:.1f} ms", [defaults(PAPER, "megakernel"), defaults(PAPER, "wavefront")]),
    Place(MAIN, "takes the megakernel {:.0f} ms, and one CPU thread {:.0f} s",
          [best_of_size("megakernel"), serial("2400x1200")]),
    Place(MAIN, "{:.0f} million paths a second in the megakernel, {:.0f} million paths a second in the "
          "wavefront", [defaults(f"{STATUE} 1024x1024", mode, "mpaths_per_s")
                        for mode in ("megakernel", "wavefront")]),
    Place(MAIN, "takes {:.1f} ms in the plain megakernel and {:.1f} ms in the block-local wavefront",
          [step_time(DIAL, "megakernel"), step_time(DIAL, "megakernel at its best")]),
    Place(MAIN, "it takes {:.1f} ms in a plain wavefront and {:.1f} ms in one with all its steps",
          [step_time(DIAL, "split kernels"), step_time(DIAL, last(DIAL))]),
    Place(MAIN, "the megakernel takes {:.1f} ms, the plain wavefront {:.1f} ms and the full one {:.1f} ms.",
          [step_time(BALLS, name) for name in ("megakernel", "split kernels", last(BALLS))]),
    Place(TABLES, "(CUDA {}, driver {})", [toolkit, driver]),
    Place(TABLES, "600x300, 50 samples | 9 M | {:.2f} ms | {:.2f} ms",
          [target(mode, PAPER, 50) for mode in ("megakernel", "wavefront")]),
    Place(TABLES, "600x300, 100 samples | 18 M | {:.2f} ms | {:.2f} ms | {:.0f} s",
          [*(target(mode, PAPER, 100) for mode in ("megakernel", "wavefront")), serial("600x300")]),
    Place(TABLES, "2400x1200, 100 samples | 288 M | {:.1f} ms | {:.1f} ms | {:.0f} s",
          [*(target(mode, "spheres 2400x1200", 100) for mode in ("megakernel", "wavefront")),
           serial("2400x1200")]),
    Place(TABLES, "72 M | {:.1f} ms | {:.1f} ms",
          [target(mode, "rtow 1200x600", 100) for mode in ("megakernel", "wavefront")]),
    *(Place(TABLES, f"\n{text} |" + " {} |" * (len(scenes) - 1) + " {}\n",
            [step_text(scene, name) for scene in scenes]) for text, name, scenes in STEPS),
    Place(TABLES, "makes the megakernel {:.1f} times (statue), {:.1f} times (dial) and {:.1f} times (Modern "
          "Hall", [step_ratio(scene, "megakernel", "megakernel at its best") for scene in LADDER[1:]]),
    Place(TABLES, "makes the wavefront {:.0f} times (spheres), {:.1f} times (statue), {:.1f} times (dial) and "
          "{:.1f} times (Modern Hall)", [step_ratio(scene, "split kernels", last(scene))
                                         for scene in LADDER]),
    Place(TABLES, "The tuned wavefront has {:.2f}, {:.2f}, {:.2f} and {:.2f} times the tuned megakernel's "
          "speed", [step_ratio(scene, "megakernel at its best", last(scene)) for scene in LADDER]),
    *(Place(TABLES, f"\n{text}" + RATES.replace(" |", "", 1), both_modes(f"{scene} 1024x1024"))
      for text, scene in SCENES),
    Place(TABLES, "it predicts {:.0f} of {:.0f} works within 10 %", [lambda: unseen()[0], lambda: unseen()[1]]),
    Place(TABLES, "---|---|---\nptexp, default options | {:.2f} | {:.2f}\n",
          mitsuba_speed("ptexp", "wavefront")),
    *(Place(TABLES, "Mitsuba 3.9.1 `" + variant + "` | {:.2f} | {:.2f}", mitsuba_speed("mitsuba", variant))
      for variant in ("llvm_ad_rgb", "scalar_rgb")),
    Place(TABLES, "ptexp, default options | {:.2f} | {:.2f} | {:.2f}", variance("defaults")),
    Place(TABLES, "light tree and Sobol points | {:.2f} | {:.2f} | {:.2f}", variance("best")),
    Place(TABLES, "bunny_room | primary | {} | {} | {} | 12,987 | 4,705\n"
          "| | ao | {} | {} | {} | 11,061 | 4,054\n| | diffuse | {} | {} | {} | 8,765 | 1,512\n",
          ray_rates("bunny_room")),
    Place(TABLES, "`statue:1M` | primary | {} | {} | {}\n| | ao | {} | {} | {}\n| | diffuse | {} | {} | {}\n",
          ray_rates("statue1M")),
    Place(TABLES, "optical depth 10: the wavefront takes {:.1f} ms, the megakernel's loop {:.1f} ms",
          [cell("media", "optical depth 10: loop"), cell("media", "optical depth 10: megakernel")]),
    Place(TABLES, "The megakernel takes {:.1f} to {:.1f} times as long",
          [lambda: min(loops()), lambda: max(loops())]),
    Place(TABLES, "ptexp takes {:.1f}, {:.1f} and {:.1f} times as many samples per second",
          [against_mitsuba(depth) for depth in ("1.0", "10.0", "50.0")]),
    Place(TABLES, "a ray takes {:.2f} times as long as where all stand still by the megakernel and {:.2f} times by the "
          "wavefront; where all sway {:.2f} and {:.2f} times",
          [by("log/2026-11-motion", "motion_cost", name=f"10K trees, {percent} %: {mode}, wide")
           for percent in (1, 100) for mode in ("megakernel", "wavefront")]),
    Place(TABLES, "by OptiX takes {:.1f} to {:.1f} times as long as ours with `--optix-hits custom`, which gives equal "
          "images, and {:.1f} to {:.1f} times with `built-in`",
          [partial(end, "custom") for end in (least_by_optix, most_by_optix)]
          + [partial(end, "built-in") for end in (least_by_optix, most_by_optix)]),
    Place(TABLES, "medians of {} seeds", [metropolis("ajar", "mlt", 0, "seeds")]),
    Place(TABLES, "scene | {} s | {} s | RMSE; FLIP, {} s\n",
          [metropolis("ajar", "mlt", place, "seconds") for place in (0, -1, -1)]),
    *(Place(TABLES, f"`{scene}`" + " | {} | {} | {:.2f}; {:.2f}", gains(scene, True))
      for scene in ("ajar", "caustic")),
    Place(TABLES, "Cornell box | {:.3f} | {:.3f} | {:.3f}; {:.2f}", gains("cornell", False)),
    Place(TABLES, "`nvidia-h200/` | {}\n", [of_one_run]),
]


def is_faster(mode, scene):
    times = {one: defaults(f"{scene} 1024x1024", one)() for one in ("megakernel", "wavefront")}
    return min(times, key=times.get) == mode


def tuning_matters_more():
    """Than the mode, in the ladder's closed room."""
    best, kernels = step(DIAL, "megakernel at its best"), step(DIAL, last(DIAL))
    tuned = min(step(DIAL, "megakernel") / best, step(DIAL, "split kernels") / kernels)
    return tuned > max(best / kernels, kernels / best)


CLAIMS = [
    Claim(MAIN, "On a million triangles the wavefront is faster",
          lambda: all(is_faster("wavefront", scene) for scene in (STATUE, "terrain:1M"))),
    Claim(MAIN, "The implementation of a mode matters more than the mode", tuning_matters_more),
    Claim(MAIN, "extrapolated from a tenth of the samples",
          lambda: row_of("image_size", name="serial, CPU 2400x1200")["extrapolated"] == "yes"
          and serial_share("2400x1200") == 10),
    Claim(TABLES, "The serial times are extrapolated from 10 of the 100 samples",
          lambda: {serial_share(size) for size in ("600x300", "2400x1200")} == {10}),
    Claim(TABLES, "Packets are fastest for coherent rays, persistent threads for incoherent rays",
          lambda: (fastest("primary"), fastest("ao") | fastest("diffuse")) == ({2}, {1})),
    Claim(TABLES, "too few for `--mode auto`", lambda: unseen()[0] < 0.9 * unseen()[1]),
    Claim(TABLES, "Persistent threads on the compressed wide tree make the wavefront faster",
          lambda: all(step(scene, last(scene)) < step(scene, "pool of the whole batch")
                      for scene in LADDER[1:])),
]


def serial_share(size):
    row = row_of("image_size", name=f"serial, CPU {size}")
    return int(row["full_spp"]) / int(row["spp"])
