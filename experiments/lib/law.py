"""A law for the megakernel's time by the wavefront's: a product of few factors, each a power of what a
table's row says of the scene. Fitted by least squares of logarithms, every family of scenes with the same
weight, and judged on families that the fit has not seen."""
import math
import random
from dataclasses import dataclass

from lib.kernels import kernels_of
from lib.scene_files import short_name

TABLES = ["defaults", "sizes", "depth", "scenes", "dial"]
NEAR = 0.1  # a prediction this near to the measured ratio is a hit
GOAL = 0.9  # share of hits
SURE = 0.9  # of the unseen cells have smaller errors than the interval's half width
RESAMPLES = 1000
SLOTS = 12  # paths that a thread of a block-local wavefront keeps
BLOCK_LOCAL_BYTES = 48 << 10  # of shared memory, from which a megakernel is one
# Requests that make the modes other than what they are by default.
DEFAULTS = {"accel": "auto", "builder": "auto", "kernel": "auto", "pool_size": "auto", "shade": "auto",
            "order_surfaces": "auto", "stages": "auto", "finish_paths": "auto", "schedule": "auto",
            "scene_memory": "auto", "wave_collisions": "0", "compaction": "atomic", "layout": "sectors",
            "regenerate": "on", "persistent": "on", "branching": "divergent", "rng": "philox",
            "sampler": "independent", "integrator": "path"}
DIAL = {"sorting megakernel": "megakernel", "wide tree": "wavefront"}  # both modes at their best there


@dataclass(frozen=True)
class Term:
    name: str
    meaning: str


CONSTANT = Term("constant", "a large image of paths without shadow rays, with few kinds of BSDFs")
TERMS = [
    CONSTANT,
    Term("drain", "paths in flight in the megakernel's blocks over all paths, where waves render: blocks run "
         "empty at the end"),
    Term("shadow", "share of shadow rays"),
    Term("sorted", "logarithm of the rays per path, where the wavefront sorts surfaces by kind: sorting "
         "scatters the next rays"),
]


@dataclass
class Cell:
    name: str
    family: str
    is_file: bool
    table: str
    ratio: float
    terms: dict
    other: str = ""  # why no law is fitted to it


def value(row, column):
    return float(row.get(column) or 0)


def family_of(scene):
    """Scenes that differ in a number alone are no unseen ones."""
    return scene.split("/")[-2] if "/" in scene else scene.partition(":")[0]


def is_default(row):
    return all(row.get(name) in (asked, None, "") for name, asked in DEFAULTS.items())


def mode_of(table, row):
    """That the row stands for; nothing if it is no row of the law."""
    if row.get("status") != "measured" or row.get("device_kind") != "cuda":
        return ""
    if table == "dial":
        return DIAL.get(row["variant"], "")
    return row["mode"] if is_default(row) and row.get("variant") != "auto" else ""


def terms_of(mega, wave, multiprocessors):
    paths, rays, shadow = (value(wave, column) for column in ("paths", "rays", "shadow_rays"))
    kernel = kernels_of(mega)["megakernel"]
    blocks = max(round(kernel.occupancy * 2048 / kernel.block_threads), 1)
    threads = multiprocessors * blocks * kernel.block_threads
    waves = 1 - value(wave, "finish_ms_median") / value(wave, "kernel_ms_median")
    is_sorted = value(wave, "order_surfaces_launches") > 0
    return {"constant": 1.0, "drain": min(SLOTS * threads / paths, 1.0) * waves,
            "shadow": shadow / (rays + shadow), "sorted": math.log(rays / paths) if is_sorted else 0.0}


def why_other(mega, wave):
    """Why the law, which is one of two implementations, says nothing of these."""
    kernel = kernels_of(mega).get("megakernel")
    if not kernel:
        return "no kernel is named"
    if kernel.shared_bytes < BLOCK_LOCAL_BYTES:
        return "the megakernel is a loop"
    return "" if wave.get("used_accel") == "cwbvh" else "no wide tree"


def cells_of(tables, multiprocessors):
    """`tables`: {name: rows}. Of equal works the first table's counts."""
    pairs = {}
    for table, rows in tables.items():
        for row in rows:
            mode = mode_of(table, row)
            if mode:
                work = (short_name(row["scene"]), row["width"], row["height"], row["spp"], row["max_depth"])
                pairs.setdefault(work, {}).setdefault(table, {})[mode] = row
    cells = []
    for (scene, width, height, spp, depth), by_table in pairs.items():
        whole = next(((table, both) for table, both in by_table.items() if len(both) == 2), None)
        if whole:
            mega, wave = whole[1]["megakernel"], whole[1]["wavefront"]
            other = why_other(mega, wave)
            cells.append(Cell(
                f"{scene} {width}x{height}x{spp}, depth {depth}", family_of(scene), "/" in scene, whole[0],
                value(mega, "kernel_ms_median") / value(wave, "kernel_ms_median"),
                {} if other else terms_of(mega, wave, multiprocessors), other))
    return cells


def solve(matrix, right):
    """The solution of a symmetric system, None if it has no single one."""
    size = len(right)
    rows = [[*row, value] for row, value in zip(matrix, right)]
    for place in range(size):
        best = max(range(place, size), key=lambda row: abs(rows[row][place]))
        if abs(rows[best][place]) < 1e-9:
            return None
        rows[place], rows[best] = rows[best], rows[place]
        for row in range(size):
            if row != place:
                factor = rows[row][place] / rows[place][place]
                rows[row] = [one - factor * other for one, other in zip(rows[row], rows[place])]
    return [rows[place][size] / rows[place][place] for place in range(size)]


def fit(cells, families=None):
    """{term: coefficient}; None where the cells do not tell them apart. A term that no cell has is left
    out. `families`: with repetitions, those that count [each once]."""
    families = families or sorted({cell.family for cell in cells})
    chosen = [(cell, families.count(cell.family) / sum(other.family == cell.family for other in cells))
              for cell in cells if cell.family in families]
    names = [term.name for term in TERMS if any(cell.terms[term.name] for cell, _ in chosen)]
    matrix = [[sum(weight * cell.terms[a] * cell.terms[b] for cell, weight in chosen) for b in names]
              for a in names]
    right = [sum(weight * cell.terms[a] * math.log(cell.ratio) for cell, weight in chosen) for a in names]
    solution = solve(matrix, right) if names else None
    return dict(zip(names, solution)) if solution else None


def intervals(cells):
    """{term: (low, high)}, 95 %, by bootstrap over families."""
    families, draw, found = sorted({cell.family for cell in cells}), random.Random(1), []
    whole = fit(cells)
    for _ in range(RESAMPLES):
        one = fit(cells, draw.choices(families, k=len(families)))
        if one and set(one) == set(whole):
            found.append(one)
    ends = {}
    for name in whole:
        ordered = sorted(one[name] for one in found)
        ends[name] = ((ordered[round(0.025 * (len(ordered) - 1))], ordered[round(0.975 * (len(ordered) - 1))])
                      if ordered else (math.nan, math.nan))
    return ends


def predicted(law, cell):
    return math.exp(sum(factor * cell.terms[name] for name, factor in law.items()))


def outside(law, known, cell):
    """The names of the terms by which a cell lies outside of those that the law was fitted to."""
    found = []
    for term in TERMS:
        values = [one.terms[term.name] for one in known]
        reach = 0.05 * (max(values) - min(values)) + 1e-9
        inside = min(values) - reach <= cell.terms[term.name] <= max(values) + reach
        if not inside or (cell.terms[term.name] and term.name not in law):
            found.append(term.name)
    return found


@dataclass
class Unseen:
    """What a law says of a cell of a family that it was not fitted to."""
    cell: Cell
    ratio: float
    outside: list
    width: float = 1.0  # of the interval, as a factor

    @property
    def error(self):
        return self.ratio / self.cell.ratio - 1

    @property
    def verdict(self):
        if self.outside:
            return f"unknown: outside in {', '.join(self.outside)}"
        if self.ratio / self.width <= 1 <= self.ratio * self.width:
            return "unknown: near 1"
        return "wavefront" if self.ratio > 1 else "megakernel"


def leave_one_out(cells):
    """[Unseen] of all cells, each predicted by the cells of the other families."""
    found = []
    for cell in cells:
        others = [other for other in cells if other.family != cell.family]
        law = fit(others)
        if law:
            found.append(Unseen(cell, predicted(law, cell), outside(law, others, cell)))
    for one in found:
        errors = sorted(abs(math.log(1 + other.error)) for other in found
                        if other.cell.family != one.cell.family and not other.outside)
        one.width = math.exp(errors[math.ceil(SURE * len(errors)) - 1]) if errors else math.inf
    return found


def on_files(cells):
    """[Unseen] of the scene files, predicted by the built-in scenes."""
    known = [cell for cell in cells if not cell.is_file]
    law = fit(known) if known else None
    return [Unseen(cell, predicted(law, cell), outside(law, known, cell))
            for cell in cells if cell.is_file] if law else []


def hits(errors):
    """(those within NEAR, all, root of the mean square)"""
    errors = list(errors)
    return (sum(abs(error) <= NEAR for error in errors), len(errors),
            math.sqrt(sum(error ** 2 for error in errors) / max(len(errors), 1)))
