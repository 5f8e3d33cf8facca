#!/usr/bin/env python3
"""Path state: from which size of a path on does another mode become the fastest?

`--path-bytes N` gives every path N more bytes, which each ray reads, changes and stores wherever the
mode keeps a path: the wavefront in its pool, the megakernel's loop in registers, its voting warps in
shared memory and its sorting blocks in their slots. They stand for spectra, derivatives, guiding or
motion. The images are the same for all N and modes. On a GPU `registers` and `spills` (bytes per
thread) are those of the kernel that shades; with --counters `predicted` and `counted` are the bytes
that a ray moves between multiprocessors and L2. A GPU needs a build with PTEXP_PATH_STATE; what has
no kernel, the loop in media for example, is a refused row.
"""
import shlex
import sys

from lib import harness
from lib.harness import Configuration, Experiment, Plot
from lib.kernels import kernels_of
from lib.scene_files import add_scene_files, scene_files, short_name
from lib.sentences import against, fastest, in_groups, listed, relation, show, time_of

BYTES = [0, 32, 64, 128, 256]
SCENES = {
    "statue:1M": "--scene statue:1M --width 1024 --height 1024 --spp 16 --max-depth 8",
    "dial:16:0:closed": "--scene dial:16:0:closed --width 512 --height 512 --spp 16 --max-depth 8",
    # The lean kernels of spheres and quads carry nothing on CUDA.
    "cornell": "--scene cornell --kernel-set general --width 1024 --height 1024 --spp 16 --max-depth 8",
}
FILES = "--width 1024 --height 1024 --spp 16 --max-depth 8"
QUICK = {
    "statue:1K": "--scene statue:1K --width 16 --height 16 --spp 2 --max-depth 8",
    "cornell": "--scene cornell --kernel-set general --width 16 --height 16 --spp 2 --max-depth 8",
}
CPU = {"megakernel": "--mode megakernel", "wavefront": "--mode wavefront"}
CUDA = {
    "megakernel, loop": "--mode megakernel --kernel loop --accel bvh2",
    "megakernel, vote": "--mode megakernel --kernel vote --accel cwbvh",
    "megakernel, sort": "--mode megakernel --kernel sort --accel cwbvh",
    "wavefront": "--mode wavefront --accel cwbvh",
}
OWN = ("registers", "spills", "predicted", "counted")


def add_arguments(parser):
    add_scene_files(parser)
    parser.add_argument("--bytes", type=int, nargs="+", default=BYTES, metavar="N",
                        help="bytes that a path carries, multiples of 16 to 256 [%(default)s]")
    parser.add_argument("--counters", action="store_true",
                        help="on a GPU: also count the bytes that a ray moves")


def configurations(arguments, device):
    scenes = QUICK if arguments.quick else {
        **SCENES, **{short_name(path): f"--scene {shlex.quote(path)} {FILES}" for path in scene_files(arguments)}}
    on_gpu = device.kind == "cuda"
    counts = " --counters" if on_gpu and arguments.counters else ""
    return [Configuration(f"{scene}: {mode}, {size} bytes",
                          f"{options} {image} --path-bytes {size}{counts}",
                          {"panel": scene, "series": mode, "x": size, **dict.fromkeys(OWN, "")},
                          same_image=scene)
            for scene, image in scenes.items()
            for mode, options in (CUDA if on_gpu else CPU).items()
            for size in arguments.bytes]


def bytes_per_ray(row, *counters):
    values = [row.get(f"counted_{name}") for name in counters]
    rays = float(row.get("counted_rays") or 0)
    return f"{sum(map(float, values)) / rays:.4g}" if rays and all(values) else ""


def finish(rows, _arguments):
    for row in rows:
        kernels = kernels_of(row)
        kernel = kernels.get("shade_surface") or kernels.get("megakernel")
        if kernel:
            row["registers"], row["spills"] = str(kernel.registers), str(kernel.spill_bytes)
        row["counted"] = bytes_per_ray(row, "l2_read_bytes", "l2_written_bytes")
        if row["mode"] == "wavefront":
            row["predicted"] = bytes_per_ray(row, "predicted_read_bytes", "predicted_written_bytes")


def turn_of(rows):
    """What becomes the fastest mode of a scene's rows as paths grow: a sentence."""
    leaders = []  # (bytes, the fastest modes)
    for size, mine in in_groups(rows, "x").items():
        best, equal = fastest(mine)
        leaders.append((int(size), {best["series"], *(row["series"] for row in equal)}))
    leaders.sort(key=lambda leader: leader[0])
    (least, first), (most, _) = leaders[0], leaders[-1]
    if least == most:
        return f"measured with {least} bytes alone"
    turns, before = [], first
    for size, modes in leaders[1:]:
        if not modes & before:
            turns.append(f"from {size} bytes on {listed(sorted(modes))}")
            before = modes
        else:
            before = modes & before
    return (f"fastest with {least} bytes: {listed(sorted(first))}; "
            + ("; ".join(turns) if turns else f"the same to {most} bytes"))


def conclude(rows, _arguments):
    lines = []
    for scene, mine in in_groups(rows, "panel").items():
        lines.append(f"{scene}: {turn_of(mine)}")
        for mode, of_mode in in_groups(mine, "series").items():
            small, large = (pick(of_mode, key=lambda row: int(row["x"])) for pick in (min, max))
            if small is large:
                continue
            more = int(large["x"]) - int(small["x"])
            verdict = against(small, large, "without")
            if relation(time_of(small), time_of(large)) != "overlap":
                each = (time_of(large).middle - time_of(small).middle) / int(large["rays"]) * 1e6
                verdict += f", {show(each)} ns a ray"
            lines.append(f"{scene}, {mode}: {more} more bytes are {verdict}")
    return lines


EXPERIMENT = Experiment(
    "path_state", __doc__.splitlines()[0], configurations,
    Plot("lines", "Path state: time over the bytes that a path carries more", "bytes per path",
         log_y=False),
    add_arguments=add_arguments, finish=finish, table=("x", *OWN), conclude=conclude)

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
