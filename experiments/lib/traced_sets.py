"""Experiments on rays alone: sets of rays are made by `ptexp rays` and traced by `ptexp trace`."""
import tempfile
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path

from lib import harness
from lib.grouped import measure_table, measured_of
from lib.program import failure_of
from lib.ray_files import reorder


@dataclass
class RaySet:
    rays: str  # the file
    make: list  # ptexp's arguments that make it
    traces: list  # and those that trace it, one way each
    order: str = ""  # of the rays, as ray_files.py names it; "": as they were made
    labels: dict = field(default_factory=dict)  # columns of the experiment's own


def add_arguments(parser):
    parser.add_argument("--scenes", nargs="*", default=[], metavar="FILE",
                        help="meshes (.mesh) and scenes to measure besides the built-in ones")
    parser.add_argument("--size", type=int, default=2048, metavar="N",
                        help="rays are those of an image of N x N pixels [%(default)s]")


def trace_command(scene, rays, accel, builder, variant, device, arguments):
    return ["trace", "--quiet", "--mesh", scene, "--rays", rays, "--accel", accel, "--builder",
            builder, *(["--variant", variant] if variant else []), "--device", device.choice,
            "--repeat", str(arguments.repeat), "--warmup", str(arguments.warmup),
            "--csv", str(Path(rays).with_name("rows.csv"))]


def without_folder(row, folder):
    """Not where it was measured."""
    row["ray_file"] = Path(row["ray_file"]).name
    row["mesh"] = "/".join(p for p in Path(row["mesh"]).parts[-2:] if p != "..")
    row["command"] = row["command"].replace(f"{folder}/", "")
    return row


def option(command, name):
    return command[command.index(name) + 1] if name in command else ""


def measure(experiment, program, rays, arguments):
    """A row for every way to trace one set of rays."""
    folder, rows = Path(rays.rays).parent, []
    no_rays = failure_of(program, rays.make, arguments.timeout)
    if rays.order and not no_rays:
        reorder(rays.rays, rays.order)
    for trace in rays.traces:
        table = Path(folder, "rows.csv")
        message = no_rays or failure_of(program, trace, arguments.timeout)
        row = {"experiment": experiment.name, "status": "failed" if message else "measured",
               "message": message or "", **rays.labels}
        if message:
            ways = {name: option(trace, f"--{name}") for name in ("accel", "builder", "variant")}
            row.update(ways, ray_file=Path(rays.rays).name, mesh=option(trace, "--mesh"))
        else:
            row.update(without_folder(harness.read_rows(table)[0], folder))
            table.unlink()
        rows.append(row)
    Path(rays.rays).unlink(missing_ok=True)
    return rows


def table_text(rows):
    lines = []
    for row in rows:
        result = (f"failed: {row['message']}" if row["status"] == "failed" else
                  f"{float(row['mrays_per_s']):10.1f} Mrays/s")
        way = f"{row['accel']:6} {row['builder']:6} {row['variant']:10}"
        lines.append(f"{row['ray_file']:40} {way} {result}")
    return "\n".join(lines)


def run(experiment, arguments, sets_of):
    """harness.main's runner; `sets_of`: (device, arguments, folder) -> ray sets in that folder."""
    program, device = harness.program_and_device(arguments)
    sets = list(sets_of(device, arguments, "."))
    if arguments.list:
        return harness.list_commands(program, [command for rays in sets
                                               for command in [rays.make, *rays.traces]])

    def groups():
        with tempfile.TemporaryDirectory(prefix="ptexp-") as folder:
            for rays in sets_of(device, arguments, folder):
                yield Path(rays.rays).name, partial(measure, experiment, program, rays, arguments)
    path, rows = measure_table(experiment, arguments, program, device, kind="ray set",
                               parts=list(map(asdict, sets)), groups=groups())
    if rows is None:
        print(f"{table_text(harness.read_rows(path))}\n\ntable: {path}")
        return 0
    measured = measured_of(rows)
    print("\n".join([table_text(rows), "", *experiment.conclude(measured, arguments),
                     f"table: {path}"]))
    return 0 if len(measured) == len(rows) else 1
