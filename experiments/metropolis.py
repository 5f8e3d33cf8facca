#!/usr/bin/env python3
"""Metropolis: what is it worth against path tracing, at equal time?

Path tracing takes Sobol points, with light and BSDF sampling combined by the power heuristic, and
lights chosen as ptexp does by itself (by power, or by the tree where they are many): of the ways in
the table `sampling` these are the best in every scene. Roulette is left out, for it gains nothing
there. Metropolis (`mlt`) takes its defaults, or what --chains and the like say.

First each renders for each time (--time-limit), and in the megakernel for the shortest. So it is
known how many samples or mutations per pixel the faster mode takes in that time, the bootstrap
included. With these numbers --seeds images of each are rendered, some at once, since nothing is
timed any more; errors are medians over them, with intervals. `gain` is path tracing's relMSE
divided by that of mlt: path tracing needs so many times the time, where errors fall as 1 / time.

The reference is the better of two, which path tracing and mlt render in --reference-seconds: the
one to which all images of the longest time are nearer. Its own noise brings gains nearer to 1. The
two must differ by no more than their noise: `references` says whether they agree.
"""
import os
import shlex
import shutil
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from statistics import median

from lib import harness
from lib.errors import MEASURES, REFERENCE_SEED, errors
from lib.harness import Configuration, Experiment, Plot
from lib.image_check import with_options
from lib.intervals import bootstrap, median_interval
from lib.scene_files import add_scene_files, scene_files, short_name
from lib.sentences import in_groups, interval, listed, show, with_interval

DEPTHS = {"ajar": 12, "caustic": 10, "cornell": 8}
FILE_DEPTH = 8
PICTURES = ["ajar", "caustic"]
PATH, MLT = "path", "mlt"
OPTIONS = {PATH: "--sampler sobol", MLT: "--integrator mlt"}
MAIN, OTHER = "wavefront", "megakernel"
MLT_OPTIONS = ["chains", "large-step-probability", "mutation-size", "bootstrap"]
BOOTSTRAP_MOST = 1 << 29  # of a reference: 2 GiB
DIFFER = 4  # times the relMSE that noise explains: beyond it references disagree
ENDS = ["median", "low", "high"]


def add_arguments(parser):
    parser.set_defaults(rounds=2)
    add_scene_files(parser)
    add = parser.add_argument
    add("--size", type=int, default=256, metavar="N",
        help="width and height in pixels [%(default)s]")
    add("--seconds", type=float, nargs="+", default=[0.1, 0.25, 0.5, 1.0], metavar="S",
        help="equal times [0.1 0.25 0.5 1]")
    add("--seeds", type=int, default=16, metavar="N",
        help="images of each scene, time and integrator [%(default)s]")
    add("--reference-seconds", type=float, default=10.0, metavar="S",
        help="of both references of a scene [%(default)s]")
    add("--parallel", type=int, default=4, metavar="N",
        help="images that are rendered at once, after the times are measured [%(default)s]")
    for name in MLT_OPTIONS:
        add(f"--{name}", default="", metavar="X", help="of mlt, as ptexp takes it")


def settle(arguments):
    """What --quick makes of the arguments."""
    arguments.seconds = sorted(set(arguments.seconds))
    if arguments.quick:
        arguments.size, arguments.seeds = 12, 3
        arguments.seconds, arguments.reference_seconds = [0.01, 0.02], 0.1
        # An iteration of the chains is more than a sample per pixel: the shortest time has one.
        arguments.bootstrap, arguments.chains = "1000", "256"


def scenes_of(arguments):
    return {short_name(scene): scene for scene in [*DEPTHS, *scene_files(arguments)]}


def image_of(name, scene, integrator, arguments):
    chosen = [f"--{option} {shlex.quote(value)}" for option in MLT_OPTIONS
              for value in [getattr(arguments, option.replace("-", "_"))] if value]
    return " ".join([f"--scene {shlex.quote(scene)} --width {arguments.size} --height "
                     f"{arguments.size} --max-depth {DEPTHS.get(name, FILE_DEPTH)}",
                     OPTIONS[integrator], *(chosen if integrator == MLT else [])])


def configurations(arguments, _device):
    settle(arguments)
    rows = []
    for name, scene in scenes_of(arguments).items():
        for integrator in OPTIONS:
            def add(mode, seconds, series, x):
                rows.append(Configuration(
                    f"{name}: {series}, {seconds:g} s", f"--mode {mode} "
                    f"{image_of(name, scene, integrator, arguments)} --time-limit {seconds:g}",
                    {"panel": name, "series": series, "x": x, "seconds": f"{seconds:g}",
                     "samples": "", "seeds": "",
                     **{f"{label}_{end}": "" for label in [*MEASURES, "gain", "rmse_gain",
                                                           "flip_gain"] for end in ENDS},
                     "reference": "", "references": ""},
                    repeat=arguments.rounds, warmup=1, same_image=f"{name}: {integrator}"))
            for seconds in arguments.seconds:
                add(MAIN, seconds, integrator, f"{1000 * seconds:g}")
            add(OTHER, arguments.seconds[0], f"{integrator}, {OTHER}", "")
    return rows


def samples_in(row, seconds):
    """Samples or mutations per pixel in this time, as fast as in the row: after the bootstrap."""
    pixels = int(row["width"]) * int(row["height"])
    done = float(row.get("mlt_mutations") or 0) / pixels or float(row["samples_done"])
    before = float(row.get("mlt_bootstrap_ms") or 0)
    took = float(row["kernel_ms_median"]) - before
    return done * max(1000 * seconds - before, 0) / took


def put_samples(rows):
    """The label `samples` of one scene's rows: what the faster mode takes in the row's seconds.
    How much faster it is in the shortest time counts for all."""
    for integrator, mine in in_groups([row for row in rows if row["x"]], "series").items():
        shortest = min(mine, key=lambda row: float(row["seconds"]))
        other = [row for row in rows if row["series"] == f"{integrator}, {OTHER}"]
        seconds = float(shortest["kernel_ms_median"]) / 1000
        faster = max([samples_in(row, seconds) / samples_in(shortest, seconds) for row in other]
                     + [1.0])
        for row in mine:
            row["samples"] = str(max(round(faster * samples_in(row, float(row["seconds"]))), 1))


def longest(rows, integrator):
    """The row of one scene's longest time, or None."""
    mine = [row for row in rows if row["x"] and row["series"] == integrator]
    return max(mine, key=lambda row: float(row["seconds"]), default=None)


class Renders:
    """The images of a comparison, in a folder; several are rendered or compared at once."""

    def __init__(self, arguments, folder):
        self.arguments, self.folder = arguments, Path(folder)
        self.program, self.device = harness.program_and_device(arguments)
        self.jobs, self.scenes = {}, scenes_of(arguments)

    def add(self, row, samples, seed, kind="exr", scale=1):
        """The path of the image of the row's scene and integrator; it is rendered by render().
        `scale`: times the samples and the bootstrap paths of the row."""
        name, integrator = row["panel"], row["series"]
        image = image_of(name, self.scenes[name], integrator, self.arguments)
        path = str(self.folder / f"{len(self.jobs)}.{kind}")
        # Their numbers must not follow from that of the samples: they are those of the timed run.
        fixed = ""
        if row.get("mlt_chains"):
            bootstrap_paths = min(round(scale * int(row["mlt_bootstrap"])), BOOTSTRAP_MOST)
            fixed = f"--chains {row['mlt_chains']} --bootstrap {bootstrap_paths}"
        self.jobs[path] = [*with_options(image, fixed), "--mode", MAIN, "--spp",
                           str(max(round(scale * int(samples)), 1)),
                           "--seed", str(seed), "--device", self.device.choice, "--quiet",
                           "--output", path]
        return path

    def add_reference(self, row, kind="exr"):
        """By the integrator of a row of the longest time."""
        scale = self.arguments.reference_seconds / float(row["seconds"])
        return self.add(row, row["samples"], REFERENCE_SEED, kind, scale)

    def render(self):
        with ThreadPoolExecutor(self.arguments.parallel) as pool:
            for _ in pool.map(lambda job: harness.run_ptexp(
                    self.program, *job, timeout_s=self.arguments.timeout), self.jobs.values()):
                pass

    def errors(self, pairs):
        """Of (image, reference), in the same order."""
        with ThreadPoolExecutor(os.cpu_count()) as pool:  # `compare` is slow, and one thread
            return list(pool.map(lambda pair: errors(self.program, *pair), pairs))


def put_values(row, label, middle, ends):
    row.update({f"{label}_{end}": f"{value:.6g}" for end, value in zip(ENDS, [middle, *ends])})


def scale_error(row):
    """Of mlt, the relative standard error of the bootstrap's mean luminance: no time lowers it."""
    brightness = float(row.get("mlt_brightness") or 0)
    return float(row["mlt_brightness_error"]) / brightness if brightness else 0.0


def reference_of(renders, images, rows, references):
    """(the integrator whose reference all images of the longest time are nearer to, whether the two
    differ by no more than their noise: 'agree', 'DISAGREE' or, with one alone, '')"""
    if len(references) < 2:
        return next(iter(references)), ""
    last = {integrator: longest(rows, integrator) for integrator in references}
    jobs = [(by, of, image) for by in references for of, row in last.items()
            for image in images[row["name"]]]
    found = {}
    for (by, of, _), errors_of in zip(jobs, renders.errors([(image, references[by])
                                                            for by, _, image in jobs])):
        found.setdefault((by, of), []).append(errors_of)
    best, other = sorted(references, key=lambda by: sum(
        one["rmse"] ** 2 for of in references for one in found[by, of]))
    share = float(last[best]["seconds"]) / renders.arguments.reference_seconds
    # The largest: where light is rare, most images do not know how rare.
    noise = sum(share * max(one["relmse"] for one in found[best, of]) + scale_error(row) ** 2
                for of, row in last.items())
    (between,) = renders.errors([(references[other], references[best])])
    return best, "agree" if between["relmse"] <= DIFFER * noise else "DISAGREE"


def put_errors(renders, rows, images, references):
    """The labels of one scene's rows."""
    chosen, agreement = reference_of(renders, images, rows, references)
    values = {}
    for row in rows:
        if not row["x"]:
            continue
        found = renders.errors([(image, references[chosen]) for image in images[row["name"]]])
        of_row = {label: [one[label] for one in found] for label in MEASURES}
        values[row["series"], row["seconds"]] = of_row
        row.update(seeds=str(len(found)), reference=chosen, references=agreement)
        for label, errors_of in of_row.items():
            put_values(row, label, median(errors_of), median_interval((tuple(errors_of),)))
    for row in rows:
        pair = [values.get((integrator, row["seconds"])) for integrator in (PATH, MLT)]
        if row["series"] == MLT and all(pair):
            put_gains(row, *pair)


def put_gains(row, path, mlt):
    """Path tracing's errors, divided by those of mlt. Both are {label: errors of the seeds}."""
    for label, gain in (("relmse", "gain"), ("rmse", "rmse_gain"), ("flip", "flip_gain")):
        if min(path[label] + mlt[label]) > 0:
            def quotient(samples):
                return median(samples[0]) / median(samples[1])
            both = [path[label], mlt[label]]
            put_values(row, gain, quotient(both), bootstrap([[one] for one in both], quotient))


def put_pictures(renders, pictures):
    """Copies {(scene, name): file} to beside the table, as the report wants them."""
    table = harness.table_path(EXPERIMENT, renders.device, renders.arguments)
    for (scene, name), path in pictures.items():
        if name != "reference":
            target = table.with_name(f"{table.stem}-{scene}-{name}.png")
            shutil.copyfile(path, target)
            shutil.copyfile(pictures[scene, "reference"], target.with_suffix(".reference.png"))


def finish(rows, arguments):
    by_scene = in_groups(rows, "panel")
    with tempfile.TemporaryDirectory(prefix="ptexp-") as folder:
        renders = Renders(arguments, folder)
        images, references, pictures = {}, {}, {}
        for name, mine in by_scene.items():
            put_samples(mine)
            last = {integrator: row for integrator in OPTIONS
                    if (row := longest(mine, integrator)) is not None}
            references[name] = {by: renders.add_reference(row) for by, row in last.items()}
            images.update({row["name"]: [renders.add(row, row["samples"], seed)
                                         for seed in range(1, arguments.seeds + 1)]
                           for row in mine if row["x"]})
            if name in PICTURES and last:
                pictures.update({(name, by): renders.add(row, row["samples"], 1, "png")
                                 for by, row in last.items()})
                pictures[name, "reference"] = renders.add_reference(last.get(MLT, last.get(PATH)),
                                                                    "png")
        print(f"renders {len(renders.jobs)} images for the errors", flush=True)
        renders.render()
        for name, mine in by_scene.items():
            if references[name]:
                put_errors(renders, mine, images, references[name])
        put_pictures(renders, pictures)


def winner(row):
    """Of a row of mlt: who has the lower relMSE, or 'neither'; '': not known."""
    gain = interval(row, "gain")
    if not (gain and gain.known):
        return ""
    return MLT if gain.low > 1 else PATH if gain.high < 1 else "neither"


def who_wins(name, rows):
    """A sentence on the rows of mlt of one scene, by their times."""
    last = rows[-1]
    word, gain = winner(last), interval(last, "gain")
    after = f"after {last['seconds']} s"
    if not word:
        return f"{name}: not known, for there are no errors of both"
    if word == "neither":
        text = (f"no significant difference {after}: path tracing has {with_interval(gain)} times "
                "the relMSE of mlt")
    elif word == MLT:
        text = f"mlt wins: {after} path tracing has {with_interval(gain)} times its relMSE"
    else:
        text = (f"path tracing wins: {after} mlt has {with_interval(gain.inverse())} times its "
                "relMSE")
    others = [f"{with_interval(value)} in {label}" for label in ("RMSE", "FLIP")
              for value in [interval(last, f"{label.lower()}_gain")] if value]
    text += f"; path tracing's error by mlt's is {listed(others)}" if others else ""
    words = [winner(row) for row in rows]
    if len(rows) > 1:
        text += ("; likewise at the other times" if len(set(words)) == 1 else
                 "; lower relMSE: " + listed(f"{word} after {row['seconds']} s"
                                             for word, row in zip(words, rows)))
    return f"{name}: {text}"


def about_rates(name, rows, mlt):
    """Mutations beside paths, both by all of the time, and how many were accepted."""
    path = longest(rows, PATH)
    text = []
    if path:
        pixels = int(mlt["width"]) * int(mlt["height"]) / 1e6
        ours, theirs = (pixels * int(row["samples"]) / float(row["seconds"]) for row in (mlt, path))
        text.append(f"{show(ours)} M mutations/s against {show(theirs)} M paths/s "
                    f"({ours / theirs:.0%})")
    accepted = [f"{float(mlt[column]):.0%} of the {size} steps" for column, size in
                (("mlt_small_acceptance", "small"), ("mlt_large_acceptance", "large"))
                if mlt.get(column)]
    if accepted:
        text.append(f"accepted are {listed(accepted)}")
    if mlt.get("mlt_bootstrap_ms"):
        text.append(f"the bootstrap takes {show(float(mlt['mlt_bootstrap_ms']))} ms and knows the "
                    f"image's scale within {scale_error(mlt):.1%}")
    return f"{name}: {'; '.join(text)}" if text else ""


def conclude(rows, _arguments):
    lines = []
    for name, mine in in_groups(rows, "panel").items():
        of_mlt = sorted((row for row in mine if row["series"] == MLT),
                        key=lambda row: float(row["seconds"]))
        if not of_mlt:
            continue
        last = of_mlt[-1]
        lines += [who_wins(name, of_mlt), about_rates(name, mine, last)]
        if last["references"]:
            lines.append(f"{name}: errors against the reference of {last['reference']}; those of "
                         f"both {last['references']}"
                         + ("" if last["references"] == "agree" else
                            ", by more than the noise of these images explains: light that they "
                            "found too rarely, or a bias"))
    return [line for line in lines if line]


EXPERIMENT = Experiment(
    "metropolis", __doc__.splitlines()[0], configurations,
    Plot("lines", "Metropolis light transport and path tracing at equal time", "time [ms]",
         "relMSE", y="relmse"),
    add_arguments=add_arguments, finish=finish, conclude=conclude,
    table=("samples", "relmse_median", "gain_median", "gain_low", "gain_high"),
    # Times must not end these: they are as long as they need.
    image_check="--width 256 --height 256 --spp 8 --time-limit 3600",
    quick_image_check="--width 24 --height 12 --spp 2 --time-limit 3600")

if __name__ == "__main__":
    sys.exit(harness.main(EXPERIMENT))
