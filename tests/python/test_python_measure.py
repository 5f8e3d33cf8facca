"""measure, sweep and compare_modes: on planted times, by numpy, and against statistics of real renders."""
import contextlib
import csv
import inspect
import io
import itertools
import math
import os
import subprocess
import sys
import unittest
from types import SimpleNamespace
from unittest import mock

from ptexp_package import PTEXP, ROOT, TestCase, np, ptexp

from ptexp import _intervals, _measure

sys.path.insert(0, str(ROOT / "scripts"))
sys.path.insert(0, str(ROOT / "experiments"))
from lib import intervals as of_experiments  # noqa: E402
from report_parts import shared, words  # noqa: E402

SMALL = {"width": 32, "height": 24, "spp": 2}


class Planted:
    """Stands for ptexp.render: its times are given, its calls kept."""

    def __init__(self, time_of, rays_of=lambda options: 2000):
        self.time_of, self.rays_of, self.calls = time_of, rays_of, []

    def __call__(self, _scene, **options):
        number = len(self.calls)
        self.calls.append(options)
        runs = []
        for repeat in range(options["repeat"]):
            time = self.time_of(options, number, repeat)
            runs.append({"kernel_ms": time, "stages": [{"stage": "intersect", "time_ms": time / 2},
                                                       {"stage": "shadow", "time_ms": time / 4}]})
        counts = {"paths": 1000, "rays": self.rays_of(options), "shadow_rays": 500}
        return SimpleNamespace(stats={"runs": runs, "counts": counts, "device": {"name": "an abacus"}})

    def __enter__(self):
        patch = mock.patch.object(_measure, "render", self)
        patch.start()
        self.stop = patch.stop
        return self

    def __exit__(self, *_):
        self.stop()


def noise(number, repeat):
    return math.sin(12.9898 * number + 78.233 * repeat)


class Turns(TestCase):
    scene = ptexp.load("cornell", **SMALL)

    def test_modes_take_turns_and_every_second_round_goes_backwards(self):
        with Planted(lambda *_: 1.0) as planted:
            table = ptexp.measure(self.scene, modes=["serial", "megakernel", "wavefront"], repeat=5, warmup=2, rounds=3,
                                  max_depth=3)
        self.assertEqual([call["mode"] for call in planted.calls],
                         ["serial", "megakernel", "wavefront", "wavefront", "megakernel", "serial",
                          "serial", "megakernel", "wavefront"])
        self.assertEqual([call["repeat"] for call in planted.calls], [2, 2, 2, 2, 2, 2, 1, 1, 1])
        self.assertEqual({(call["warmup"], call["max_depth"], call["output"]) for call in planted.calls}, {(2, 3, None)})
        self.assertEqual([(row["mode"], row["repeat"]) for row in table],
                         [("serial", 5), ("megakernel", 5), ("wavefront", 5)])

    def test_rounds_without_a_repeat_are_left_out(self):
        with Planted(lambda *_: 1.0) as planted:
            ptexp.measure(self.scene, modes="wavefront", repeat=2, rounds=3)
        self.assertEqual([call["repeat"] for call in planted.calls], [1, 1])

    def test_a_sweep_has_all_combinations(self):
        with Planted(lambda options, *_: options["spp"] * options["max_depth"]) as planted:
            table = ptexp.sweep(self.scene, max_depth=[2, 4], spp=np.array([1, 8]), look_from=(0, 1, 5), kernel_set=("lean", "general"),
                                modes="megakernel", repeat=1)
        self.assertEqual([(row["max_depth"], row["spp"], row["kernel_set"]) for row in table],
                         list(itertools.product((2, 4), (1, 8), ("lean", "general"))))
        self.assertEqual([row["time_ms"] for row in table], [2, 2, 16, 16, 4, 4, 32, 32])
        self.assertEqual({call["look_from"] for call in planted.calls}, {(0, 1, 5)})

    def test_progress_counts_renders(self):
        calls = []
        with Planted(lambda *_: 1.0):
            ptexp.measure(self.scene, repeat=2, warmup=1, rounds=2, progress=lambda *call: calls.append(call))
        self.assertEqual(calls, [(2, 8), (4, 8), (6, 8), (8, 8)])

    def test_what_is_wrong(self):
        for arguments, message in (({"repeat": 0}, "--repeat 0"), ({"rounds": 0}, "--rounds 0"), ({"warmup": -1}, "--warmup -1"),
                                   ({"repeat": 2.5}, "--repeat 2.5"), ({"modes": []}, "nothing to measure"),
                                   ({"output": "a.png"}, "--output"), ({"mode": "serial"}, "--mode"), ({"ssp": 8}, "spp"),
                                   ({"modes": "fast"}, "--mode fast"), ({"strict": True}, "ptexp.load"),
                                   ({"spp": [1, 2]}, "--spp")):
            with self.subTest(arguments), self.assertRaisesRegex(ptexp.OptionError, message):
                ptexp.measure(self.scene, **arguments)
        with self.assertRaisesRegex(ptexp.OptionError, "--kernel"):
            ptexp.sweep(self.scene, kernel=["loop"])
        with self.assertRaisesRegex(ptexp.OptionError, "nothing to measure"):
            ptexp.sweep(self.scene, spp=[])

    def test_what_is_raised_has_the_table_so_far(self):
        def time_of(_options, number, _repeat):
            if number == 3:
                raise KeyboardInterrupt
            return 1.0 + number

        with Planted(time_of), self.assertRaises(KeyboardInterrupt) as raised:
            ptexp.measure(self.scene, repeat=2, rounds=2)
        self.assertEqual([(row["mode"], row["rounds_ms"]) for row in raised.exception.table],
                         [("megakernel", [[1.0]]), ("wavefront", [[2.0], [3.0]])])


class Numbers(TestCase):
    scene = ptexp.load("cornell", **SMALL)

    def test_rows(self):
        with Planted(lambda options, number, repeat: 10 + noise(number, repeat)):
            row, = ptexp.measure(self.scene, modes="megakernel", repeat=9)
        times = sorted(time for times in row["rounds_ms"] for time in times)
        self.assertEqual([len(times) for times in row["rounds_ms"]], [3, 3, 3])
        self.assertAlmostEqual(row["time_ms"], np.median(times))
        self.assertEqual((row["min_ms"], row["max_ms"]), (times[0], times[-1]))
        self.assertTrue(times[0] <= row["low_ms"] < row["time_ms"] < row["high_ms"] <= times[-1])
        self.assertAlmostEqual(row["mrays_per_s"], 2500 / np.median(times) / 1e3)
        self.assertEqual((row["rays"], row["device"]), (2000, "an abacus"))

    def test_intervals_agree_with_a_bootstrap_by_numpy(self):
        rounds = tuple(tuple(10 + noise(number, 9) + 0.3 * noise(number, repeat) for repeat in range(4)) for number in range(5))
        generator, medians = np.random.default_rng(1), []
        for _ in range(20000):
            chosen = generator.integers(5, size=5)
            medians.append(np.median([generator.choice(rounds[number], 4) for number in chosen]))
        expected = np.quantile(medians, (0.025, 0.975))
        np.testing.assert_allclose(_intervals.median_interval(rounds), expected, atol=0.05)  # of all times at once: 0.13 off

    def test_stages(self):
        with Planted(lambda *_: 8.0):
            table = ptexp.measure(self.scene, modes="wavefront", repeat=2, by_stage=True)
        self.assertEqual([(row["stage"], row["time_ms"]) for row in table], [("all", 8), ("intersect", 4), ("shadow", 2)])
        self.assertEqual([row["mrays_per_s"] is None for row in table], [False, True, True])

    def test_words(self):
        def compared(megakernel, wavefront, spread, repeat=10):
            with Planted(lambda options, number, repeat: {"megakernel": megakernel, "wavefront": wavefront}[options["mode"]]
                         + spread * noise(number, repeat)):
                return ptexp.compare_modes(self.scene, repeat=repeat)
        for megakernel, wavefront, spread, word, faster in (
                (10, 5, 0.1, "faster", "wavefront"), (5, 10, 0.1, "slower", "megakernel"), (10, 10.01, 0.5, "same", None),
                (10, 12, 9, "ambiguous", None)):
            comparison = compared(megakernel, wavefront, spread)
            with self.subTest(word):
                self.assertEqual((comparison.word, comparison.faster), (word, faster))
                self.assertTrue(comparison.low <= comparison.ratio <= comparison.high)
                self.assertTrue(str(comparison).endswith(f": {word}"), comparison)
        self.assertAlmostEqual(compared(10, 5, 0).ratio, 2)
        alone = compared(10, 5, 0, repeat=1)
        self.assertEqual((alone.low, alone.high, alone.word), (None, None, "ambiguous"))

    def test_drift_of_the_machine_is_no_difference_of_modes(self):
        # Each round is 1.5 times as slow as the one before; in each the wavefront takes 0.9 times as long.
        with Planted(lambda options, number, repeat: 1.5 ** (number // 2) * (0.9 if options["mode"] == "wavefront" else 1)):
            comparison = ptexp.compare_modes(self.scene, repeat=9)
        np.testing.assert_allclose((comparison.low, comparison.ratio, comparison.high), 1 / 0.9)

    def test_other_work_is_not_compared(self):
        with Planted(lambda *_: 1.0, lambda options: len(options["mode"])), self.assertRaisesRegex(ptexp.Error, "rays"):
            ptexp.compare_modes(self.scene)

    def test_experiments_and_report_have_these_definitions(self):
        installed = inspect.getsource(_intervals)
        for function in (words.change, words.relation, of_experiments.bootstrap, of_experiments.median_interval):
            self.assertEqual(inspect.getmodule(function), shared.intervals)
        self.assertEqual(inspect.getsource(shared.intervals), installed)


class Shows(TestCase):
    def table(self, **options):
        with Planted(lambda options, number, repeat: options.get("spp", 1) + 0.1 * noise(number, repeat)):
            return ptexp.sweep(Numbers.scene, **options)

    def test_as_text_and_html(self):
        table = self.table(spp=[1, 16], by_stage=True, modes="wavefront")
        lines = repr(table).splitlines()
        self.assertEqual(lines[0].split(), ["spp", "mode", "stage", "ms", "95", "%", "interval", "Mrays/s"])
        self.assertEqual([line.split()[:3] for line in lines[1:]],
                         [[spp, "wavefront", stage] for spp in ("1", "16") for stage in ("all", "intersect", "shadow")])
        self.assertEqual(table._repr_html_().count("<tr>"), 7)
        self.assertEqual(repr(self.table(repeat=1)).splitlines()[1].split()[0], "megakernel")

    def test_as_a_dataframe(self):
        frame = self.table(spp=[1, 16]).dataframe()
        self.assertEqual(frame.groupby("spp")["time_ms"].median().round().tolist(), [1, 16])
        with mock.patch.dict(sys.modules, {"pandas": None}), self.assertRaisesRegex(ptexp.Error, "pandas"):
            self.table().dataframe()

    def test_as_a_plot(self):
        import matplotlib
        matplotlib.use("Agg")
        lines = self.table(spp=[16, 1, 4]).plot()
        self.assertEqual([text.get_text() for text in lines.get_legend().get_texts()], ["megakernel", "wavefront"])
        self.assertEqual([line.lines[0].get_xdata().tolist() for line in lines.containers], [[1, 4, 16]] * 2)
        bars = self.table().plot()
        self.assertEqual([label.get_text() for label in bars.get_yticklabels()], ["megakernel", "wavefront"])
        figure, axes = matplotlib.pyplot.subplots()
        stages = self.table(by_stage=True).plot(axes)
        self.assertIs(stages, axes)
        self.assertEqual(len(stages.patches), 4)
        np.testing.assert_allclose([bar.get_width() for bar in stages.patches], [0.5, 0.5, 0.25, 0.25], atol=0.1)
        np.testing.assert_allclose([bar.get_x() for bar in stages.patches], [0, 0, 0.5, 0.5], atol=0.1)
        self.table(repeat=1).plot()
        matplotlib.pyplot.close("all")
        with mock.patch.dict(sys.modules, {"matplotlib.pyplot": None}), self.assertRaisesRegex(ptexp.Error, "matplotlib"):
            self.table().plot()


class Real(TestCase):
    def test_times_and_counts_are_those_of_the_statistics(self):
        kept = []
        real = _measure.render

        def render(*arguments, **options):
            kept.append(real(*arguments, **options))
            return kept[-1]

        scene = ptexp.load("cornell", **SMALL, device="cpu", output=self.folder / "a.png", csv=self.folder / "a.csv",
                           quiet=False, repeat=50)
        printed = io.StringIO()
        with mock.patch.object(_measure, "render", render), contextlib.redirect_stdout(printed):
            table = ptexp.measure(scene, repeat=3, rounds=2, by_stage=True)
        self.assertEqual((list(self.folder.iterdir()), printed.getvalue()), ([], ""))
        self.assertEqual([image.stats["options"]["mode"] for image in kept],
                         ["megakernel", "wavefront", "wavefront", "megakernel"])
        for mode in ("megakernel", "wavefront"):
            mine = [image.stats for image in kept if image.stats["options"]["mode"] == mode]
            whole = next(row for row in table if row["mode"] == mode and row["stage"] == "all")
            self.assertEqual(whole["rounds_ms"], [[run["kernel_ms"] for run in stats["runs"]] for stats in mine])
            self.assertEqual(whole["rays"], mine[0]["counts"]["rays"])
            parts = {row["stage"] for row in table if row["mode"] == mode} - {"all"}
            self.assertEqual(parts, {stage["stage"] for stage in mine[0]["stages"]})
        self.assertIn("shade_surface", {row["stage"] for row in table})

    def test_a_file_and_a_name(self):
        comparison = ptexp.compare_modes("spheres", spheres=3, **SMALL, repeat=2, rounds=1)
        self.assertEqual([row["paths"] for row in comparison.table], [32 * 24 * 2] * 2)
        table = ptexp.sweep("cornell", spp=(1, 4), width=16, height=16, modes=["auto"], repeat=1)
        self.assertEqual([(row["spp"], row["paths"]) for row in table], [(1, 256), (4, 1024)])

    @unittest.skipIf(not PTEXP or sys.version_info < (3, 10), "experiments need the program and Python 3.10")
    def test_an_experiment_takes_a_scene_in_memory(self):
        make = "import ptexp\nscene = ptexp.load('cornell', width=16, height=12)\nscene.params['camera.fov'] = 15\n"
        own = self.write("own.py", make)
        command = [sys.executable, ROOT / "experiments/defaults.py", "--only", own, "--ptexp", PTEXP, "--device", "cpu",
                   "--repeat", "2", "--warmup", "0", "--rounds", "1", "--output", self.folder / "results"]
        environment = {**os.environ, "PYTHONPATH": os.environ.get("PTEXP_PYTHON_PATH", "")}
        run = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300, check=False)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        path, = self.folder.glob("results/*/defaults-only.csv")
        with open(path, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        names = {}
        exec(make, names)  # pylint: disable=exec-used
        rays = ptexp.render(names["scene"], spp=64).stats["counts"]["rays"]
        self.assertEqual([(row["mode"], row["status"], int(row["rays"])) for row in rows],
                         [("megakernel", "measured", rays), ("wavefront", "measured", rays)])
        own.write_text(make + "scene = 'cornell'\n")
        run = subprocess.run([*command, "--fresh"], env=environment, capture_output=True, text=True, timeout=300, check=False)
        self.assertIn("its variable `scene` is str; expected a ptexp.Scene", run.stdout + run.stderr)


if __name__ == "__main__":
    unittest.main()
