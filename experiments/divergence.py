#!/usr/bin/env python3
"""Divergence: how full are the warps, at each point of the code and bounce?

Needs a GPU and a build with PTEXP_DIVERGENCE (docs/statistics.md), named by --ptexp. It renders each
configuration once, for counts need no repeats: --repeat, --warmup and --rounds have no effect. There
are no times in the table, because those of such a build tell nothing. Scene files may be named as
further arguments of --scenes.
"""
import json
import shlex
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path

from lib import harness
from lib.harness import Configuration, Experiment, HarnessError, Plot
from lib.scene_files import add_scene_files, scene_files, short_name

BUILT_IN = ["dial:16:0:closed", "statue:1M", "cloud"]
VARIANTS = {
    "megakernel": "--mode megakernel",
    "uber": "--mode wavefront --compaction atomic --stages split --order-surfaces off",
    "uber, sorted": "--mode wavefront --stages split --order-surfaces on",
    "uber, tags": "--mode wavefront --compaction none --stages split --order-surfaces off",
}
SIZE, SPP, DEPTH = 1024, 4, 8
DRAWN = ["node", "primitive", "shade_surface", "bsdf", "shadow_node"]  # points in the picture
# What the lanes at a point are in all, by the statistics' counts.
SUMS = {"generate": "paths", "intersect": "rays", "shadow": "shadow_rays"}


def configurations(arguments, _device):
    scenes, size, spp = BUILT_IN + scene_files(arguments), SIZE, SPP
    if arguments.quick:
        scenes, size, spp = [scene.replace("1M", "1K") for scene in scenes], 64, 1
    return [Configuration(
        f"{short_name(scene)}: {variant}",
        f"--scene {shlex.quote(scene)} --width {size} --height {size} --spp {spp} "
        f"--max-depth {DEPTH} {options}", {"scene": short_name(scene), "variant": variant})
        for scene in scenes for variant, options in VARIANTS.items()]


def command_of(configuration, device):
    return [*shlex.split(configuration.arguments), "--device", device.choice]


def statistics_of(program, command, timeout_s):
    """What ptexp writes by --stats."""
    with tempfile.TemporaryDirectory(prefix="ptexp-") as folder:
        stats = Path(folder, "run.json")
        harness.run_ptexp(program, *command, "--quiet", "--output", str(Path(folder, "image.ppm")),
                          "--stats", str(stats), timeout_s=timeout_s)
        return json.loads(stats.read_text(encoding="utf-8"))


def use_of(histograms):
    """(groups of lanes, lanes in all of them) of histograms together."""
    counts = [sum(column) for column in zip(*histograms)]
    return sum(counts), sum(n * count for n, count in enumerate(counts, 1))


def check_sums(name, statistics):
    """Every path and ray is counted once, by the lanes that begin it."""
    in_media = any(part["point"] == "shade_medium" for part in statistics["divergence"])
    for point, count in SUMS.items():
        _, lanes = use_of([part["lanes"] for part in statistics["divergence"]
                           if part["point"] == point] or [[0]])
        expected = statistics["counts"][count]
        if point == "shadow" and lanes > expected and in_media:
            continue  # one goes on behind each boundary of a medium
        if lanes != expected:
            raise HarnessError(f"{name}: {lanes} lanes at {point}, but {expected} {count}; "
                               "expected equal numbers")


def rows_of(configuration, statistics):
    """A row for each point and bounce."""
    name, labels = configuration.name, configuration.labels
    rows = []
    for part in statistics["divergence"]:
        point, bounce, counts = part["point"], part["bounce"], part["lanes"]
        groups, lanes = use_of([counts])
        rows.append({
            "experiment": EXPERIMENT.name, "name": f"{name}, {point}, bounce {bounce}",
            "status": "measured", "message": "", "panel": f"{labels['scene']}: {point}",
            "series": labels["variant"], "x": bounce + 1 if point in DRAWN else "", **labels,
            "point": point, "bounce": bounce, "groups": groups, "lanes": lanes,
            "mean_lanes": f"{lanes / groups:.4f}", "simt_efficiency": f"{lanes / groups / 32:.5f}",
            "groups_of": ";".join(map(str, counts))})
    return rows


def mean_text(rows):
    groups = sum(row["groups"] for row in rows)
    return f"{sum(row['lanes'] for row in rows) / groups:.1f}" if groups else ""


def table_text(rows):
    """Of one configuration: mean lanes by point, of all bounces and of each."""
    bounces = sorted({row["bounce"] for row in rows})
    lines = [f"{'mean lanes':18}{'all':>6}" + "".join(f"{bounce:6}" for bounce in bounces)]
    for point in dict.fromkeys(row["point"] for row in rows):
        of_point = [row for row in rows if row["point"] == point]
        means = [mean_text([row for row in of_point if row["bounce"] == b]) for b in bounces]
        lines.append(f"{point:18}{mean_text(of_point):>6}"
                     + "".join(f"{mean:>6}" for mean in means))
    return "\n".join(line.rstrip() for line in lines)


def run(experiment, arguments):
    program, device = harness.program_and_device(arguments, counts_lanes=True)
    chosen = configurations(arguments, device)
    commands = {c.name: command_of(c, device) for c in chosen}
    if arguments.list:
        return harness.list_commands(program, commands.values())
    harness.check_gpu(experiment, device)
    print(f"{experiment.question}\non {device.choice}: {device.name} ({device.detail})", flush=True)
    path = harness.table_path(experiment, device, arguments)
    facts = harness.provenance(experiment, program, device, arguments)
    rows = []
    for configuration in chosen:
        statistics = statistics_of(program, commands[configuration.name], arguments.timeout)
        check_sums(configuration.name, statistics)
        new = rows_of(configuration, statistics)
        print(f"\n{configuration.name}\n{table_text(new)}", flush=True)
        rows += new
    harness.write_table(path, rows, {
        **facts, "complete": True, "plot": asdict(experiment.plot),
        "configurations": {name: shlex.join(["ptexp", *command])
                           for name, command in commands.items()}})
    print(f"\ntable: {path}\n{harness.draw(path)}")
    return 0


EXPERIMENT = Experiment(
    "divergence", __doc__.splitlines()[0], configurations,
    Plot("lines", "Active lanes: 1024 x 1024, 4 samples, depth 8", "rays of a path",
         "active lanes of 32, mean", y="mean_lanes", log_y=False),
    add_arguments=add_scene_files, needs_gpu=True)

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT, runner=run))
