"""How efficient larger clusters would be: simulations over numbers of GPUs, rules for units, maps of
what pixels cost, slow and late devices. Writes results/simulated/scaling.csv and .json."""
import csv
import shlex
import sys
from dataclasses import asdict, dataclass, field
from pathlib import Path
from statistics import median

from lib.description import HarnessError
from lib.intervals import median_interval
from lib.program import ROOT
from lib.provenance import now
from lib.sentences import in_groups
from lib.simulate_ranks import Cluster, Job, broadcast_s, cluster_of
from lib.simulate_windows import WindowRule, simulate_windows
from lib.table import write_table

MAPS = ROOT / "experiments" / "cost_maps"
WIDTH, HEIGHT, PER_NODE = 3840, 2160, 8
RULES = {
    "windows of 1/2, units of 5 s": {"first_share": 2, "unit_s": 5},
    "windows of 1/4, units of 5 s": {"first_share": 4, "unit_s": 5},
    "windows of 1/4, units of 1 s": {"first_share": 4, "unit_s": 1},
    "windows of 1/8, units of 1 s": {"first_share": 8, "unit_s": 1},
    "windows of 1/16, units of 5 s": {"first_share": 16, "unit_s": 5},
    "windows of 1/16, units of 1 s": {"first_share": 16, "unit_s": 1},
}


@dataclass(frozen=True)
class Case:
    """What is different from equal devices and no scene to send."""
    name: str
    cluster: dict = field(default_factory=dict)
    scene_bytes: float = 0
    image_s: float = 0


CASES = [
    Case("equal devices"),
    Case("1 % at half speed", {"slow_share": 0.01, "slow_times": 2}),
    Case("1 % at quarter speed", {"slow_share": 0.01, "slow_times": 4}),
    Case("a tenth of the nodes up to 1 s late", {"late_share": 0.1, "late_s": 1}),
    Case("a scene of 1 GB", scene_bytes=1e9),
    Case("a scene of 1 GB, binary tree in pieces", {"broadcast": "binary"}, scene_bytes=1e9),
    Case("an image written in 0.3 s", image_s=0.3),
]


def add_arguments(parser):
    add = parser.add_argument_group("with --simulate").add_argument
    add("--simulate", action="store_true", help="simulate clusters and measure nothing")
    add("--nodes", metavar="N", type=int, nargs="+", default=[1, 8, 32, 128],
        help="machines of 8 GPUs [1 8 32 128]")
    add("--seconds", metavar="S", type=float, nargs="+", default=[10],
        help="what the image takes if nothing is lost [10]")
    add("--cost-maps", metavar="FILE", nargs="+", default=[],
        help="rows of numbers: what pixels cost, by their place [those of experiments/cost_maps]")
    add("--bandwidth", metavar="GB/S", type=float, default=12.5,
        help="of rank 0's link, in each direction [%(default)s]")
    add("--latency", metavar="US", type=float, default=5, help="of a message [%(default)s]")
    add("--service", metavar="US", type=float, default=50,
        help="of rank 0 for a message [%(default)s]")
    add("--unit-overhead", metavar="MS", type=float, default=1,
        help="of a unit on its device [%(default)s]")
    add("--copy-bandwidth", metavar="GB/S", type=float, default=5,
        help="of rank 0, which puts units into the image [%(default)s]")
    add("--pixel-bytes", metavar="N", type=int, default=32,
        help="of the film; 216 with all AOVs, about [%(default)s]")


def read_map(path):
    try:
        with open(path, newline="", encoding="utf-8") as file:
            rows = [[float(cost) for cost in row] for row in csv.reader(file) if row]
    except ValueError as error:
        raise HarnessError(f"{path}: expected rows of numbers: {error}") from None
    if not rows or min(map(min, rows)) < 0 or sum(map(sum, rows)) <= 0:
        raise HarnessError(f"{path}: expected rows of positive numbers")
    return rows


def cost_maps(arguments):
    paths = list(map(Path, arguments.cost_maps)) or sorted(MAPS.glob("*.csv"))
    return {path.stem: read_map(path) for path in paths}


def network(arguments):
    return {"bandwidth": 1e9 * arguments.bandwidth, "latency_s": 1e-6 * arguments.latency,
            "service_s": 1e-6 * arguments.service,
            "copy_bandwidth": 1e9 * arguments.copy_bandwidth}


def simulated(case, rule, nodes, seconds, maps, arguments):
    """An outcome for each map; with devices that differ, other ones are slow or late."""
    for seed, rows in enumerate(maps.values()):
        cluster = cluster_of(nodes, PER_NODE, seed=seed, **{**network(arguments), **case.cluster})
        job = Job(seconds * sum(cluster.speeds), overhead_s=1e-3 * arguments.unit_overhead,
                  film_bytes=arguments.pixel_bytes * WIDTH * HEIGHT,
                  scene_bytes=case.scene_bytes, image_s=case.image_s)
        yield simulate_windows(job, cluster, WindowRule(WIDTH, HEIGHT, **rule), rows)


def predicted(count, one_s, size, over_links, arguments):
    """The efficiency to be expected of `count` equal devices of one machine for an image of so many
    pixels that takes one of them one_s: the median over the maps. `over_links`: all but the first
    are other ranks."""
    network_of_ranks = network(arguments)
    if not over_links:
        network_of_ranks["service_s"] = 0
    cluster = Cluster((1.0,) * count, local=1 if over_links else count, **network_of_ranks)
    job = Job(one_s, overhead_s=1e-3 * arguments.unit_overhead,
              film_bytes=arguments.pixel_bytes * size[0] * size[1])
    return median(simulate_windows(job, cluster, WindowRule(*size), rows).efficiency
                  for rows in cost_maps(arguments).values())


def row_of(case, rule, nodes, seconds, outcomes):
    """The medians over the maps, and the range of the efficiency."""
    efficiencies = tuple(outcome.efficiency for outcome in outcomes)
    low, high = median_interval((efficiencies,))
    row = {"experiment": "scaling", "name": f"{case.name}, {seconds:g} s, {nodes * PER_NODE} GPUs: "
           f"{rule}", "status": "measured", "series": rule, "panel": f"{case.name}, {seconds:g} s",
           "x": nodes * PER_NODE, "seconds": f"{seconds:g}",
           "efficiency_median": f"{median(efficiencies):.4f}", "efficiency_low": f"{low:.4f}",
           "efficiency_high": f"{high:.4f}", "efficiency_worst": f"{min(efficiencies):.4f}"}
    for name in outcomes[0].losses:
        row[f"lost_{name}"] = f"{median([outcome.losses[name] for outcome in outcomes]):.4f}"
    row["units"] = f"{median([outcome.units for outcome in outcomes]):.0f}"
    row["rank_0_busy"] = f"{max(outcome.service for outcome in outcomes):.4f}"
    row["link_busy"] = f"{max(outcome.link for outcome in outcomes):.4f}"
    return row


def conclude(rows):
    lines = []
    for panel, mine in in_groups(rows, "panel").items():
        most = max(int(row["x"]) for row in mine)
        last = [row for row in mine if int(row["x"]) == most]
        lines.append(f"{panel}, {most:,} GPUs: efficiency " + "; ".join(
            f"{row['efficiency_median']} (worst map {row['efficiency_worst']}) with {row['series']}"
            for row in last))
        best = max(last, key=lambda row: float(row["efficiency_worst"]))
        lost = {name.removeprefix("lost_"): float(value) for name, value in best.items()
                if name.startswith("lost_") and float(value) >= 0.0005}
        lines.append(f"    with the best of them is lost: " + ", ".join(
            f"{name} {100 * value:.1f} %" for name, value in
            sorted(lost.items(), key=lambda item: -item[1])))
    return lines


def run(experiment, arguments):
    maps = cost_maps(arguments)
    nodes_of, cases = arguments.nodes, CASES
    if arguments.quick:
        nodes_of, cases = [1, 2], CASES[:2]
    rows = []
    for seconds in arguments.seconds:
        for case in cases:
            for nodes in nodes_of:
                for rule, values in RULES.items():
                    outcomes = list(simulated(case, values, nodes, seconds, maps, arguments))
                    rows.append(row_of(case, rule, nodes, seconds, outcomes))
            print(f"{case.name}, {seconds:g} s", flush=True)
    folder = arguments.output / "simulated"
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"scaling{'-' if arguments.label else ''}{arguments.label}.csv"
    conclusions = conclude(rows)
    write_table(path, rows, {
        "experiment": "scaling", "question": experiment.question, "date": now(),
        "command": shlex.join(["python3", *sys.argv]), "quick": arguments.quick,
        "simulated": True, "complete": True, "maps": list(maps),
        "image": {"width": WIDTH, "height": HEIGHT, "pixel_bytes": arguments.pixel_bytes},
        "network": network(arguments), "rules": RULES, "cases": list(map(asdict, cases)),
        "broadcast_s": {tree: broadcast_s(nodes_of[-1] * PER_NODE, 1e9, 1e9 * arguments.bandwidth,
                                          1e-6 * arguments.latency, tree)
                        for tree in ("binomial", "binary")},
        "conclusions": conclusions})
    print("\n".join(["", *conclusions, f"table: {path}"]))
