"""What experiments make of their rows: labels and sentences, from numbers that are known."""
import importlib
import itertools
import random
import runpy
import shlex
import struct
import sys
import tempfile
import types
import unittest
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "experiments"))
from lib import options  # noqa: E402
from lib.description import HarnessError  # noqa: E402

CUDA, CPU = (types.SimpleNamespace(kind=kind) for kind in ("cuda", "cpu"))
FULL = types.SimpleNamespace(quick=False, scenes=[])


def row(middle, spread=0.01, **labels):
    """A measured row whose interval has this half width, relative to the median."""
    return {"kernel_ms_median": str(middle), "kernel_ms_low": str(middle * (1 - spread)),
            "kernel_ms_high": str(middle * (1 + spread)), "repeat": "10",
            **{name: str(value) for name, value in labels.items()}}


def experiment(name):
    is_run = (ROOT / "experiments" / f"{name}.py").is_file()
    return importlib.import_module(name if is_run else f"lib.{name}")


def option(configuration, name):
    tokens = configuration.arguments.split()
    return tokens[tokens.index(name) + 1] if name in tokens else None


class Tables(unittest.TestCase):
    def test_columns_of_the_release_before_have_their_new_names(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "old.csv")
            path.write_text("name,sort_hits_ms_median,sort_hits_launches\na,1.5,2\n", encoding="utf-8")
            self.assertEqual(experiment("table").read_rows(path), [
                {"name": "a", "route_hits_ms_median": "1.5", "route_hits_launches": "2"}])


class Sentences(unittest.TestCase):
    def setUp(self):
        self.sentences = experiment("sentences")

    def test_only_intervals_that_are_apart_differ(self):
        against = self.sentences.against
        self.assertEqual(against(row(4), row(2), "A"), "2.00 times as fast as A")
        self.assertEqual(against(row(2), row(4), "A"), "2.00 times as slow as A")
        self.assertEqual(against(row(2), row(2.1, 0.05), "A"),
                         "no significant difference to A (1.05 times its time)")
        once = {"kernel_ms_median": "1", "repeat": "1"}
        self.assertEqual(against(row(2), once, "A"),
                         "2.00 times as fast as A, by times without a spread")

    def test_the_best_and_what_equals_it(self):
        rows = [row(3, x="c"), row(1, 0.1, x="a"), row(1.1, 0.1, x="b")]
        self.assertEqual(self.sentences.best_of(rows, "x"),
                         "a and b, without a significant difference")
        self.assertEqual(self.sentences.best_of(rows[:2], "x"), "a")

    def test_growth_is_the_exponent(self):
        rows = [row(x**0.5, x=x) for x in (100, 1, 10000)]
        self.assertEqual(self.sentences.growth(rows, "spheres"),
                         "10,000 times the spheres take 100 times as long (spheres^0.50)")
        self.assertEqual(self.sentences.growth(rows[:1], "spheres"), "")


class Ladder(unittest.TestCase):
    def setUp(self):
        self.ladder = experiment("ladder")

    def test_each_rung_changes_one_thing(self):
        by_scene = {}
        for made in self.ladder.configurations(FULL, CUDA):
            by_scene.setdefault(made.same_image, []).append(made)
        self.assertEqual(len(by_scene), 3)
        names = ("--stages", "--layout", "--compaction", "--regenerate",
                 "--finish-paths", "--schedule", "--pool-size", "--accel", "--persistent",
                 "--wave-rays", "--order-surfaces")
        for scene, steps in by_scene.items():
            self.assertEqual(len(steps), 12 if scene == "spheres" else 13)
            steps = [step for step in steps if option(step, "--mode") == "wavefront"]
            for above, below in zip(steps[1:], steps):
                changed = {name for name in names if option(above, name) != option(below, name)
                           and not (name == "--persistent" and option(below, name) is None)}
                if "--stages" in changed:  # and what only split stages have
                    changed -= {"--wave-rays", "--order-surfaces"}
                self.assertEqual(len(changed), 1, f"{above.name}: {changed}")
            # Persistent warps, the default, trace wide trees alone: each comes by itself.
            self.assertEqual([(option(step, "--accel"), option(step, "--persistent"))
                              for step in steps[-3:]],
                             [(None, None)] * 3 if scene == "spheres" else
                             [("bvh2", None), ("cwbvh", "off"), ("cwbvh", "on")])

    def test_gains_are_those_over_the_rung_before(self):
        rows = [row(ms, panel="s", x=x, gain="") for ms, x in ((4, "a"), (8, "b"), (2, "c"))]
        self.ladder.finish(rows, None)
        self.assertEqual([one["gain"] for one in rows], ["", "0.500", "4.000"])
        self.assertEqual(self.ladder.conclude(rows, None),
                         ["s: b: 2.00 times as slow as a", "s: c: 4.00 times as fast as b",
                          "s, all steps together: 2.00 times as fast as a"])

    def test_no_graph_on_a_cpu(self):
        self.assertFalse([made for made in self.ladder.configurations(FULL, CPU)
                          if "graph" in made.arguments])


class Metropolis(unittest.TestCase):
    def setUp(self):
        self.metropolis = experiment("metropolis")

    def rows(self, **more):
        """A scene of 10x10 pixels: 100 samples per second in paths, 50 in mutations."""
        made = [(series, seconds, x, rate) for series, rate in (("path", 100), ("mlt", 50))
                for seconds, x in ((0.5, "500"), (1.0, "1000"))]
        made += [("path, megakernel", 0.5, "", 80), ("mlt, megakernel", 0.5, "", 60)]
        return [row(2000 * seconds, panel="s", series=series, x=x, seconds=seconds, width=10,
                    height=10, name=f"{series} {seconds}", samples_done=2 * rate * seconds,
                    mlt_mutations="", samples="", **more) for series, seconds, x, rate in made]

    def test_the_faster_mode_says_how_many_samples(self):
        rows = self.rows()
        rows[2]["mlt_mutations"] = str(2 * 50 * 0.5 * 100)  # samples_done may be rounded
        rows[2]["samples_done"] = "1"
        self.metropolis.put_samples(rows)
        self.assertEqual([one["samples"] for one in rows], ["50", "100", "30", "60", "", ""])
        for one in rows[2:4] + rows[5:]:  # 50 mutations per second and 60, after 400 ms
            one.update(mlt_bootstrap_ms="400", kernel_ms_median="1400", mlt_mutations="",
                       samples_done="60" if one["x"] == "" else "50")
        self.metropolis.put_samples(rows)
        self.assertEqual([one["samples"] for one in rows[2:4]], ["6", "36"])

    def test_both_integrators_have_their_options_at_equal_times(self):
        arguments = types.SimpleNamespace(
            quick=False, scenes=[], size=64, seconds=[0.5, 0.1], seeds=2, rounds=2, chains="7",
            large_step_probability="", mutation_size="0.1", bootstrap="")
        made = self.metropolis.configurations(arguments, CUDA)
        self.assertEqual(len(made), 3 * 2 * 3)
        for one in made:
            is_mlt = option(one, "--integrator") == "mlt"
            self.assertEqual((option(one, "--chains"), option(one, "--mutation-size")),
                             ("7", "0.1") if is_mlt else (None, None))
            self.assertEqual(option(one, "--sampler"), None if is_mlt else "sobol")
            self.assertEqual(option(one, "--time-limit"), one.labels["seconds"])
        self.assertEqual([one.labels["x"] for one in made[:3]], ["100", "500", ""])
        modes = {one.same_image: set() for one in made}
        for one in made:
            modes[one.same_image].add(option(one, "--mode"))
        self.assertEqual(len(modes), 6)
        self.assertEqual({frozenset(of) for of in modes.values()},
                         {frozenset(("wavefront", "megakernel"))})

    def compared(self, errors_of, references=("path", "mlt"), **of_mlt):
        """The rows with their labels, where an image's or reference's square error is known, and
        two that are compared have the sum."""
        rows = self.rows()
        for one in rows[2:4]:
            one.update(of_mlt)
        images = {one["name"]: [(one["name"], seed) for seed in range(3)] for one in rows}

        def errors(pairs):
            found = [errors_of(image) + errors_of(reference) for image, reference in pairs]
            return [{"rmse": square**0.5, "relmse": square, "flip": square / 8} for square in found]
        renders = types.SimpleNamespace(errors=errors,
                                        arguments=types.SimpleNamespace(reference_seconds=10.0))
        self.metropolis.put_errors(renders, rows, images, {by: by for by in references})
        return rows

    def test_the_better_reference_is_taken_and_held_against_the_other(self):
        def error(squares):
            return lambda image: squares.get(image, 4.0 if image[0].startswith("path") else 1.0)
        rows = self.compared(error({"path": 0.4, "mlt": 0.1}))
        self.assertEqual({(one["reference"], one["references"]) for one in rows if one["x"]},
                         {("mlt", "agree")})
        self.assertEqual((rows[0]["relmse_median"], rows[0]["seeds"]), ("4.1", "3"))
        self.assertEqual((rows[0]["rmse_low"], rows[0]["flip_high"]), ("2.02485", "0.5125"))
        self.assertEqual((rows[3]["gain_median"], rows[3]["rmse_gain_median"]),
                         ("3.72727", "1.93061"))
        self.assertNotIn("gain_median", rows[1])
        self.assertNotIn("relmse_median", rows[4])
        # A tenth of (4.2 + 1.2) is what noise explains, and four times that is allowed.
        rows = self.compared(error({"path": 1.9, "mlt": 0.2}))
        self.assertEqual(rows[0]["references"], "agree")
        rows = self.compared(error({"path": 2.3, "mlt": 0.2}))
        self.assertEqual(rows[0]["references"], "DISAGREE")
        squares = error({"path": 2.3, "mlt": 0.2})
        rows = self.compared(squares, mlt_brightness="2", mlt_brightness_error="1")  # a quarter
        self.assertEqual(rows[0]["references"], "agree")
        rows = self.compared(error({"path": 0.1}), ["path"])
        self.assertEqual((rows[0]["reference"], rows[0]["references"]), ("path", ""))

    def test_who_wins(self):
        def said(*gains):
            rows = [{"seconds": str(2**i), "gain_low": low, "gain_median": middle,
                     "gain_high": high} for i, (low, middle, high) in enumerate(gains)]
            return self.metropolis.who_wins("s", rows)
        self.assertEqual(said(("2", "3", "4")),
                         "s: mlt wins: after 1 s path tracing has 3.00 [2.00, 4.00] times its "
                         "relMSE")
        self.assertEqual(said(("0.25", "0.5", "0.9"), ("0.2", "0.25", "0.5")),
                         "s: path tracing wins: after 2 s mlt has 4.00 [2.00, 5.00] times its "
                         "relMSE; likewise at the other times")
        self.assertEqual(said(("0.2", "0.5", "0.9"), ("0.9", "1.5", "2")),
                         "s: no significant difference after 2 s: path tracing has 1.50 "
                         "[0.900, 2.00] times the relMSE of mlt; lower relMSE: path after 1 s and "
                         "neither after 2 s")
        self.assertIn("not known", said(("", "", "")))

    def test_rates_and_acceptance(self):
        rows = self.rows()
        self.metropolis.put_samples(rows)
        rows[3].update(mlt_small_acceptance="0.7", mlt_large_acceptance="0.05",
                       mlt_bootstrap_ms="12.5", mlt_brightness="2",
                       mlt_brightness_error="0.03")
        self.assertEqual(self.metropolis.about_rates("s", rows, rows[3]),
                         "s: 0.00600 M mutations/s against 0.0100 M paths/s (60%); accepted are "
                         "70% of the small steps and 5% of the large steps; the bootstrap takes "
                         "12.5 ms and knows the image's scale within 1.5%")


class Defaults(unittest.TestCase):
    def configurations(self, *command):
        arguments = options.parse_arguments(experiment("defaults").EXPERIMENT, command)
        return arguments, experiment("defaults").configurations(arguments, CPU)

    def test_ones_own_scene_alone_at_its_own_size(self):
        with tempfile.TemporaryDirectory(prefix="my scenes ") as folder:
            file = Path(folder).resolve() / "room.xml"
            file.write_text("<scene/>", encoding="utf-8")
            arguments, made = self.configurations("--scenes", str(file), "--only", str(file))
            name = f"{file.parent.name}/room.xml"
            self.assertEqual([one.name for one in made], [f"{name}: megakernel", f"{name}: wavefront"])
            self.assertEqual([shlex.split(one.arguments) for one in made], [
                ["--mode", mode, "--scene", str(file), "--spp", "64"]
                for mode in ("megakernel", "wavefront")])
            self.assertEqual(arguments.label, "only")  # the table of all scenes stays
            _, made = self.configurations("--only", str(file), "cornell", "--quick")
            self.assertEqual([(one.labels["panel"], option(one, "--width")) for one in made[::2]],
                             [(name, "32"), ("cornell 32x32", "32")])
            _, made = self.configurations("--scenes", str(file))
            self.assertEqual({option(one, "--width") for one in made}, {"600", "2400", "1024"})
            self.assertIn(str(file), shlex.split(made[-1].arguments))
        arguments, made = self.configurations()
        self.assertEqual((arguments.label, len(made)), ("", 18))
        for wrong in ("absent.xml", "cornel"):
            with self.assertRaisesRegex(HarnessError, f"--only {wrong}: no such file, and no scene"):
                self.configurations("--only", wrong)


class Toggles(unittest.TestCase):
    def test_a_panels_first_row_is_what_it_says(self):
        toggles = experiment("toggles")
        made = {one.name: one.arguments.split() for one in toggles.configurations(FULL, CPU)}
        size = made["megakernel: default"][2:]
        for mode in ("megakernel", "wavefront"):
            self.assertEqual(made[f"{mode}: default"], ["--mode", mode, *size])
        split = made["wavefront, split stages: no other change"]
        self.assertEqual(split, ["--mode", "wavefront", *size, "--stages", "split"])
        self.assertEqual(split, made["wavefront: stages split"])
        of_split = [one for name, one in made.items() if name.startswith("wavefront, split")]
        self.assertEqual({len(one) - len(split) for one in of_split}, {0, 2})
        rows = [row(ms, panel=panel, x=x) for ms, panel, x in (
            (4, "w", "default"), (8, "w", "a"), (2, "s", "no other change"), (1, "s", "b"))]
        toggles.finish(rows, None)
        self.assertEqual([one["relative_to_first"] for one in rows],
                         ["1.000", "2.000", "1.000", "0.500"])
        self.assertEqual(toggles.conclude(rows, None), [
            "w, a: 2.00 times as slow as the default", "s, b: 2.00 times as fast as split stages alone"])

    def test_each_against_what_it_replaces(self):
        for name, base, said in (("toggles", "default", "the default"), ("shading", "uber", "uber")):
            rows = [row(ms, panel="p", x=x) for ms, x in ((4, "a"), (2, base), (1, "b"))]
            self.assertEqual(experiment(name).conclude(rows, None), [
                f"p, a: 2.00 times as slow as {said}", f"p, b: 2.00 times as fast as {said}"])


class BlockSize(unittest.TestCase):
    def test_idle_threads_lanes_and_occupancy(self):
        kernels = "start_clock:8:0:0:1:0.5;megakernel:51:0:0:{}:{}"
        rows = [row(ms, mode="megakernel", work="pixel", panel="p", series="s", x=edge * edge,
                    block=f"{edge}x{edge}", width=600, height=300,
                    kernels=kernels.format(edge * edge, occupancy))
                for ms, edge, occupancy in ((4, 4, 0.5), (2, 32, 0.75))]
        rows.append(row(3, mode="wavefront", work="persistent", panel="p", series="w", x=64,
                        kernels="intersect:32:0:0:64:1.0000"))
        block_size = experiment("block_size")
        block_size.finish(rows, None)
        # 19 x 10 blocks of 32 x 32 threads for 600 x 300 pixels
        idle = 1 - 600 * 300 / (19 * 10 * 1024)
        self.assertEqual([one.get("idle") for one in rows], ["0.0000", f"{idle:.4f}", None])
        self.assertEqual([one["lanes"] for one in rows], ["0.5", "1", "1"])
        self.assertEqual([one["occupancy"] for one in rows], ["0.5000", "0.7500", "1.0000"])
        said = block_size.conclude([{"idle": "", **one} for one in rows], None)
        self.assertEqual(said[:3], [
            "p, s: fastest with blocks of 1024 threads",
            "p, s: 16 threads, 0.500 of a warp: 2.00 times as slow as 1024",
            "p, s: threads without a pixel: 0.0% with 4x4, 7.5% with 32x32"])


class ImageSize(unittest.TestCase):
    def test_the_papers_mean_of_three_runs(self):
        image_size = experiment("image_size")
        made = row(5, series="serial, CPU", full_spp=100, spp=10, rounds=3, kernel_ms_min=1,
                   kernel_ms_max=9, kernel_ms_runs="4;9;1;9;7")  # 4, 9 | 1, 9 | 7
        two = {**made, "rounds": "2"}
        image_size.finish([made, two], None)
        self.assertEqual(made["image_ms_mean_of_3"], "40.000000")
        self.assertEqual(made["image_ms_median"], "50.000000")
        self.assertNotIn("image_ms_mean_of_3", two)


    def test_cpu_and_gpu_promise_an_image_each(self):
        arguments = types.SimpleNamespace(quick=False, cpu_spp=0, cpu_repeat=1, cpu_warmup=0)
        groups = {}
        for made in experiment("image_size").configurations(arguments, CUDA):
            groups.setdefault(made.same_image, set()).add(made.device)
        self.assertCountEqual(groups.values(), [{""}, {"cpu"}])


class SceneMemory(unittest.TestCase):
    def test_sentences(self):
        rows = [row(ms, panel="m", x=50, series=memory, device_kind="cuda")
                for ms, memory in ((2, "global"), (1, "constant"), (1.99, "shared"))]
        said, alone = experiment("scene_memory").conclude(
            rows + [row(3, panel="m", x=60, series="global", device_kind="cuda")], None)
        self.assertEqual(said, "m, 50 spheres: fastest in constant memory; constant: 2.00 times as "
                               "fast as global; shared: no significant difference to global (0.995 "
                               "times its time)")
        self.assertEqual(alone, "m, 60 spheres: fastest in global memory; nothing else fits")

    def test_a_cpu_says_that_the_others_need_a_gpu(self):
        said, = experiment("scene_memory").conclude(
            [row(3, panel="m", x=60, series="global", device_kind="cpu")], None)
        self.assertEqual(said, "m, 60 spheres: measured in global memory alone; the others need a "
                               "GPU")


class RandomNumbers(unittest.TestCase):
    def test_sentences(self):
        numbers = experiment("random_numbers")
        rows = [row(ms, panel="p", x=x, relmse=error, set_up_ms=set_up, memory_bytes=mib << 20)
                for ms, x, error, set_up, mib in ((2, numbers.PHILOX, 0.1, "", 100),
                                                  (4, numbers.XORWOW, 0.1, "0.5", 150),
                                                  (5, numbers.GENERAL, 0.4, "", 100),
                                                  (5, numbers.SOBOL, 0.1, "", 100))]
        self.assertEqual(numbers.conclude(rows, None), [
            "p, XORWOW: 2.00 times as slow as Philox; setting up its states takes 0.5 ms of 4; "
            "+50 MiB of memory; 1.00 times less error at equal samples (of one image each, "
            "without an interval)",
            "p, Sobol, kernels for all scenes: no significant difference to Philox, kernels for all "
            "scenes (1.00 times its time); +0 MiB of memory; 4.00 times less error at equal samples "
            "(of one image each, without an interval)"])
        self.assertEqual(numbers.cost(rows[1]), 2 * numbers.cost(rows[0]))
        for made in rows:
            made["render_init_ms_median"] = ""
        numbers.put_efficiency(rows)  # error times time: 0.2, 0.4, 2, 0.5
        self.assertEqual([made["efficiency"] for made in rows], ["1", "0.5", "0.1", "0.4"])


class Depth(unittest.TestCase):
    def test_shares_of_paths(self):
        depth = experiment("depth")
        made = [row(ms, panel="p", series=mode, x=2, max_depth=2, live_paths="200;50", rays=250,
                    paths=200) for ms, mode in ((1, "megakernel"), (2, "wavefront"))]
        depth.finish(made, None)
        self.assertEqual((made[0]["alive"], made[0]["rays_per_path"]), ("1;0.25", "1.25"))
        self.assertEqual(depth.conclude(made, None), [
            "p: a path has 1.25 rays of at most 2; of 100 paths 25.0 trace a ray 2, 3, ..., and "
            "25.0 ray 2",
            "p, megakernel: 4,000 ns a ray at depth 2", "p, wavefront: 8,000 ns a ray at depth 2",
            "p, depth 2, wavefront: 2.00 times as slow as the megakernel"])


class Scenes(unittest.TestCase):
    def test_both_at_their_best_and_as_usual(self):
        scenes = experiment("scenes")
        rows = [row(ms, panel="s", mode=mode, x=f"{mode}, {way}") for ms, mode, way in (
            (2, "megakernel", "bvh2"), (3, "megakernel", "cwbvh"),
            (4, "megakernel", "as usually written"), (1, "wavefront", "cwbvh"),
            (8, "wavefront", "as usually written"))]
        self.assertEqual(scenes.conclude(rows, None), [
            "s, both at their best, wavefront: 2.00 times as fast as the megakernel",
            "s, both as usually written, wavefront: 2.00 times as slow as the megakernel",
            "s, megakernel at its best: 2.00 times as fast as what is usual",
            "s, wavefront at its best: 8.00 times as fast as what is usual"])


class ProcessTime(unittest.TestCase):
    def setUp(self):
        self.experiment = experiment("process_time")

    def configurations(self, device, scenes=(), quick=False, samples=(1, 64)):
        arguments = types.SimpleNamespace(quick=quick, scenes=scenes, samples=list(samples),
                                          picture="image.png", rounds=7)
        return self.experiment.configurations(arguments, device)

    def test_each_round_starts_what_a_user_types(self):
        made = self.configurations(types.SimpleNamespace(kind="cuda", choice="cuda:2"))
        self.assertEqual({(one.repeat, one.warmup) for one in made}, {(7, 0)})
        empty, = (one for one in made if one.name == self.experiment.EMPTY)
        self.assertRegex(empty.arguments, r"^-I -S \S+/experiments/lib/empty_cuda.py 2$")
        self.assertEqual((empty.program, empty.renders), (sys.executable, False))
        renders = [one for one in made if one.renders and one.labels["image"] != "any process"]
        self.assertEqual({one.image for one in renders}, {"image.png"})
        self.assertEqual([(option(one, "--scene"), option(one, "--builder")) for one in renders],
                         [("spheres", None)] + [(scene, builder) for scene in (
                             "statue:1M", "statue:4M", "terrain:10M", "instances:10K", "boxes")
                                                for builder in (None, "best")])
        self.assertFalse([one for one in renders if "--mode" in one.arguments or one.prepare])
        self.assertEqual([one.labels["goal_ms"] for one in renders],
                         [40, 150, "", 300, "", 450, "", "", "", "", ""])
        on_cpu = self.configurations(CPU)
        self.assertEqual([one.name for one in on_cpu if one.labels["image"] == "any process"],
                         ["ptexp --list-devices", "one pixel"])
        self.assertEqual([one.name for one in made], list(dict.fromkeys(one.name for one in made)))

    def test_scene_files_are_warm_or_cold(self):
        cache, hall = experiment("page_cache"), "/a b/modern-hall/scene.xml"
        made = [one for one in self.configurations(CPU, [hall], samples=(1, 64, 1))
                if one.prepare]
        self.assertEqual([one.name.partition(", ")[2] for one in made], [
            f"{samples}, {way} files" for samples in ("1 sample", "64 samples")
            for way in ("auto, warm", "auto, cold", "best, warm")])
        for one in made:
            self.assertEqual(one.prepare.func, cache.drop if "cold" in one.name else cache.fill)
            self.assertEqual(one.prepare.args, (hall,))
            self.assertIn(f"--scene '{hall}' ", one.arguments)
        self.assertEqual([one.labels["goal_ms"] for one in made], [110, "", "", "", "", ""])
        quick = self.configurations(CPU, [hall], quick=True, samples=(64, 128))
        self.assertEqual(len([one for one in quick if one.prepare]), 3)

    def rows(self):
        def process(image, variant, wall, kernels="", files="", goal_ms="", **parts):
            return {**self.experiment.labels(image, variant, files, goal_ms), "repeat": "5",
                    "name": variant, "kernel_ms_median": kernels, "process_kernels_ms": kernels,
                    **{f"process_wall_ms{end}": str(wall + more) for end, more in (
                        ("", 0), ("_low", -10), ("_high", 10))},
                    **{f"process_{part}_ms": str(ms) for part, ms in parts.items()}}
        of = self.experiment
        return [process("any process", of.PYTHON, 20, undivided=20),
                process("any process", of.EMPTY, 370, undivided=370),
                process("s", "auto", 600, "60", "warm", 190, devices=200, prepare=240, end=30,
                        setup=70),
                process("s", "auto", 800, "60", "cold", devices=200, scene=480, end=40, setup=80),
                process("s", "best", 610, "70", "warm", devices=200, prepare=340)]

    def test_what_is_over_an_empty_program(self):
        rows = self.rows()
        arguments = types.SimpleNamespace(quick=False)
        self.experiment.finish(rows, arguments)  # 600 - 60 - (370 - 20)
        self.assertEqual([one["over_ms"] for one in rows],
                         ["", "", "190.000000", "390.000000", "190.000000"])
        self.assertEqual([one["verdict"] for one in rows], ["", "", "pass", "", ""])
        rows[2]["goal_ms"] = 189
        self.experiment.finish(rows, arguments)
        self.assertEqual(rows[2]["verdict"], "MISS")
        self.experiment.finish(rows, types.SimpleNamespace(quick=True))
        self.assertEqual(rows[2]["verdict"], "quick")
        on_cpu = self.rows()[2:]
        self.experiment.finish(on_cpu, arguments)
        self.assertEqual({(one["over_ms"], one["verdict"]) for one in on_cpu}, {("", "")})

    def test_an_empty_program_makes_a_context(self):
        def calls(*arguments, wrong=None):
            made = []
            cuda = types.SimpleNamespace(**{
                name: lambda *_, name=name: made.append(name) or 100 * (name == wrong)
                for name in ("cuInit", "cuDeviceGet", "cuDevicePrimaryCtxRetain", "cuCtxSetCurrent")})
            with mock.patch("ctypes.CDLL", return_value=cuda), \
                    mock.patch.object(sys, "argv", ["empty_cuda.py", *arguments]):
                runpy.run_path(str(ROOT / "experiments" / "lib" / "empty_cuda.py"))
            return made
        self.assertEqual(calls("1"), ["cuInit", "cuDeviceGet", "cuDevicePrimaryCtxRetain",
                                      "cuCtxSetCurrent"])
        self.assertEqual(calls(), [])
        with self.assertRaisesRegex(SystemExit, "cuInit: error 100"):
            calls("0", wrong="cuInit")

    def test_sentences(self):
        rows = self.rows()
        self.experiment.finish(rows, types.SimpleNamespace(quick=False))
        said = self.experiment.conclude(rows, None)
        self.assertEqual(said[0], "an empty CUDA program without Python: 350 ms")
        self.assertIn(
            "s, auto, warm files: 600 ms [590, 610], of it kernels 60.0 ms (10 %), plan and trees "
            "40 %, driver and devices 33 % and context and upload 12 %; 190 ms over its kernels "
            "and an empty CUDA program (goal 190 ms: pass)", said)
        self.assertIn("s, builder auto: no significant difference to best (0.984 times its time)",
                      said)
        self.assertIn("s, cold files: 1.33 times as slow as warm ones", said)
        for end in ("", "_low", "_high"):
            rows[4][f"process_wall_ms{end}"] = str(1200)
        self.assertIn("s, builder auto: 2.00 times as fast as best",
                      self.experiment.conclude(rows, None))


class RayFiles(unittest.TestCase):
    def setUp(self):
        self.files = experiment("ray_files")
        folder = tempfile.TemporaryDirectory(prefix="ptexp rays ")
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name, "a.rays")
        draw = random.Random(7)
        # Origins at the corners of the cells of a grid that the sort uses, too.
        self.rays = [(*(float(draw.randrange(1024)) for _ in range(3)), 0.0,
                      *(draw.uniform(-1, 1) for _ in range(3)), 9.0) for _ in range(500)]
        self.rays += [(0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 9.0),
                      (1023.0, 1023.0, 1023.0, 0.0, 1.0, 1.0, 1.0, 9.0)]

    def write(self, magic=b"TRBRAYS1"):
        self.path.write_bytes(struct.pack("<8sQIIII", magic, len(self.rays), 1, 0, 0, 0)
                              + b"".join(struct.pack("<8f", *ray) for ray in self.rays))

    def reordered(self, order):
        self.write()
        before = self.path.read_bytes()
        self.files.reorder(self.path, order)
        after = self.path.read_bytes()
        self.assertEqual(before[:32], after[:32])
        records = [[content[at:at + 32] for at in range(32, len(content), 32)]
                   for content in (before, after)]
        self.assertCountEqual(*records)
        return [struct.unpack("<8f", record) for record in records[1]]

    @staticmethod
    def comes_before(a, b):
        """Along the Morton curve, whose highest bit is z's: by the axis of the highest bit in which
        the two differ (Chan 2002, 'Closest-point problems simplified on the RAM')."""
        axis, highest = 0, 0
        for candidate in (2, 1, 0):
            difference = int(a[candidate]) ^ int(b[candidate])
            if highest.bit_length() < difference.bit_length():
                axis, highest = candidate, difference
        return a[axis] <= b[axis]

    def test_by_origin(self):
        rays = self.reordered("origin")
        self.assertTrue(all(self.comes_before(a, b) for a, b in zip(rays, rays[1:])))

    def test_by_direction(self):
        rays = self.reordered("direction")
        ways = [tuple(x < 0 for x in ray[4:7]) for ray in rays]
        self.assertEqual(len([way for way, _ in itertools.groupby(ways)]), len(set(ways)))
        for a, b in zip(rays, rays[1:]):
            same = all((x < 0) == (y < 0) for x, y in zip(a[4:7], b[4:7]))
            self.assertTrue(not same or self.comes_before(a, b))

    def test_shuffled(self):
        rays = self.reordered("shuffled")
        self.assertLess(sum(a == b for a, b in zip(rays, self.rays)), 20)

    def test_another_file_is_left_alone(self):
        self.write(magic=b"TRBHITS1")
        before = self.path.read_bytes()
        with self.assertRaisesRegex(ValueError, "a.rays: not a file of rays"):
            self.files.reorder(self.path, "origin")
        self.assertEqual(self.path.read_bytes(), before)


class RayOrder(unittest.TestCase):
    def test_what_a_sort_may_cost(self):
        def traced(ms, label):
            return {"panel": "p", "x": label, "rays": "1000", "time_ms": str(ms),
                    "time_min_ms": str(0.99 * ms), "time_max_ms": str(1.01 * ms), "repeat": "7"}
        rows = [traced(4, "as made"), traced(8, "shuffled"), traced(3, "by origin")]
        self.assertEqual(experiment("ray_order").conclude(rows, None), [
            "p, shuffled: 2.00 times the time as made (slower)",
            "p, by origin: 0.750 times the time as made (faster); it pays if sorting takes less "
            "than 1,000 ns a ray"])


class SameImages(unittest.TestCase):
    def test_structures_promise_one_image_of_triangles_alone(self):
        for name in ("scenes", "scene_memory", "growth"):
            arguments = types.SimpleNamespace(quick=True, list=True, scenes=[], output=Path("."))
            groups = {}
            for made in experiment(name).configurations(arguments, CUDA):
                if not any(f"--scene {scene}" in made.arguments for scene in (
                        "statue", "boxes", "instances", "terrain", "/")):
                    groups.setdefault(made.same_image, set()).add(option(made, "--accel"))
            self.assertTrue(groups)
            self.assertEqual(set(map(len, groups.values())), {1}, name)


class LampScene(unittest.TestCase):
    def test_lamps_look_down_and_stay_as_bright(self):
        lamps = experiment("lamp_scene")
        for count in (1, 10, 1000):
            header, _, body = lamps.lamps_ply(count).partition(b"end_header\n")
            self.assertIn(f"element face {count}\n".encode(), header)
            corners = struct.unpack(f"<{9 * count}f", body[:36 * count])
            faces = list(struct.iter_unpack("<Biii", body[36 * count:]))
            self.assertEqual([face[0] for face in faces], [3] * count)
            area, seen = 0.0, set()
            for _, *places in faces:
                a, b, c = (corners[3 * place:3 * place + 3] for place in places)
                (ux, uz), (vx, vz) = ([p[0] - a[0], p[2] - a[2]] for p in (b, c))
                area += (ux * vz - uz * vx) / 2
                self.assertLess(uz * vx - ux * vz, 0)  # the normal's y: down
                self.assertEqual({a[1], b[1], c[1]}, {2.0})
                self.assertLess(max(map(abs, a)), 10.1)
                seen.add(a)
            self.assertAlmostEqual(area, 4.0, places=3)
            self.assertEqual(len(seen), count)


if __name__ == "__main__":
    unittest.main()
