"""Tests the experiments' harness with a program that does nothing (fake_ptexp.py): medians and
intervals, rounds, runs that are cut off, failures, images that differ, builds that are slower."""
import contextlib
import csv
import importlib
import io
import itertools
import json
import math
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
from functools import partial
from pathlib import Path
from statistics import median
from unittest import mock

HERE = Path(__file__).resolve().parent
sys.dont_write_bytecode = True
EXPERIMENTS = HERE.parents[1] / "experiments"
sys.path.insert(0, str(EXPERIMENTS))
from lib import harness  # noqa: E402
from lib import intervals  # noqa: E402
from lib import page_cache  # noqa: E402
from lib import pooling  # noqa: E402
from lib import program  # noqa: E402
from lib import provenance  # noqa: E402
from lib import rounds  # noqa: E402
from lib.harness import Configuration, Experiment  # noqa: E402
from lib.image_check import with_options  # noqa: E402
from lib.program import Process  # noqa: E402

# An experiment of its own file, for a harness that is killed.
SCRIPT = """
import sys
sys.path.insert(0, {experiments!r})
from lib import harness
from lib.harness import Configuration, Experiment
sys.exit(harness.main(Experiment("fake", "Fake?", lambda *_: [
    Configuration(f"seed {{seed}}", f"--seed {{seed}}", {{"x": seed}}) for seed in (1, 2, 3)],
    None)))
"""

# Says of its age what ptexp says, as the last thing that it does.
AGE = """
import os, time
for name, text in (("run.json", '{"runs": []}'), ("row.csv", "process_start_ms\\n")):
    with open(name, "w") as file:
        file.write(text)
fields = open("/proc/self/stat").read().rpartition(")")[2].split()
with open("row.csv", "ab", buffering=0) as file:
    now_s = time.clock_gettime(time.CLOCK_BOOTTIME)
    file.write(b"%f\\n" % (1e3 * (now_s - int(fields[19]) / os.sysconf("SC_CLK_TCK"))))
    os._exit(0)
"""


def exact_interval(rounds, outside=0.025):
    """From all equally likely resamples, one by one. Rounds are equally long."""
    def resamples(times):
        return itertools.product(times, repeat=len(times))
    medians = sorted(median(itertools.chain(*drawn)) for chosen in resamples(rounds)
                     for drawn in itertools.product(*map(resamples, chosen)))
    return tuple(medians[math.ceil(share * len(medians)) - 1] for share in (outside, 1 - outside))


def median_of_first(samples):
    return median(samples[0])


class Intervals(unittest.TestCase):
    def test_few_times(self):
        self.assertEqual(intervals.median_interval(((4.0,),)), (4.0, 4.0))
        # 7 of the 27 resamples of three times have the least as their median, 7 the greatest.
        self.assertEqual(intervals.median_interval(((3.0, 1.0, 2.0),)), (1.0, 3.0))
        self.assertEqual(exact_interval(((3.0, 1.0, 2.0),)), (1.0, 3.0))
        self.assertEqual(intervals.median_interval(((3.0,), (1.0,), (2.0,))), (1.0, 3.0))
        for times in ((1.0, 2.0, 4.0, 8.0), (5.0, 5.0, 5.1, 5.1), (1.0, 2.0, 4.0, 8.0, 16.0, 32.0)):
            expected = exact_interval((times,))
            self.assertEqual(intervals.median_interval((times,)), expected)
            self.assertEqual(intervals.bootstrap([(times,)], median_of_first), expected)

    def test_rounds(self):
        for rounds in (((1.0, 2.0), (4.0, 8.0)), ((1.0, 1.1, 1.2), (3.0, 3.1, 3.2)),
                       ((1.0, 1.5), (2.0, 2.5), (4.0, 4.5))):
            low, high = intervals.median_interval(rounds)
            # The share below has a deviation of 0.0025 in 4000 draws.
            widest, narrowest = (exact_interval(rounds, share) for share in (0.0175, 0.0325))
            self.assertTrue(widest[0] <= low <= narrowest[0] < narrowest[1] <= high <= widest[1])
        self.assertEqual(intervals.median_interval(((1.0, 2.0), (4.0, 8.0))), (1.0, 8.0))
        # Repeats of a round that agree say nothing about other rounds.
        drifting = ((1.0,) * 5, (2.0,) * 5, (3.0,) * 5)
        self.assertEqual(intervals.median_interval(drifting), (1.0, 3.0))

    def test_nine_times(self):
        # The median of a resample is at most the k-th time if five of nine draws are: a binomial.
        def at_most(k):
            return sum(math.comb(9, i) * (k / 9) ** i * (1 - k / 9) ** (9 - i)
                       for i in range(5, 10))
        low, high = (next(k for k in range(1, 10) if at_most(k) >= share)
                     for share in (0.025, 0.975))
        times = tuple(random.Random(5).sample([float(k) for k in range(1, 10)], 9))
        self.assertEqual(intervals.median_interval((times,)), (low, high))
        self.assertEqual((low, high), (2, 8))

    def test_drift_cancels_in_ratios(self):
        before = [[1.0, 1.0], [2.0, 2.0], [3.0, 3.0]]
        after = [[1.5, 1.5], [3.0, 3.0], [4.5, 4.5]]
        self.assertEqual(intervals.bootstrap(
            [before, after], lambda s: median(s[1]) / median(s[0])), (1.5, 1.5))

    def test_percentiles_are_values_of_the_sample(self):
        # 1..4000: the 100th has 2.5 % at or below it, the 3900th 97.5 %.
        self.assertEqual(intervals.ends(range(1, 4001)), (100, 3900))
        self.assertEqual(intervals.ends(range(1, 41)), (1, 39))
        self.assertEqual(intervals.ends(range(1, 42)), (2, 40))
        self.assertEqual(intervals.ends([7]), (7, 7))

    def test_sharing_into_rounds(self):
        self.assertEqual(intervals.in_rounds([1, 2, 3, 4, 5], 3), [[1, 2], [3, 4], [5]])


class Pooling(unittest.TestCase):
    def process(self, times, **row):
        columns = {"kernel_ms_median": "0", "kernel_ms_min": "0", "kernel_ms_max": "0",
                   "serial_ms_median": "0", "serial_ms_min": "0", "serial_ms_max": "0",
                   "compact_ms_median": "", "other_ms_median": "0", "other_ms_min": "0",
                   "other_ms_max": "0", "mpaths_per_s": "0", "mrays_per_s": "0", "paths": "6000",
                   "rays": "9000", "shadow_rays": "3000", "repeat": "0", "scene_ms": "1"}
        return Process("measured", row={**columns, **row}, runs=[
            {"kernel_ms": time, "stages": {"serial": time / 2, "a": 0.25, "b": 0.5}}
            for time in times])

    def test_golden_row(self):
        row = pooling.pooled([self.process([5.0, 1.0], scene_ms="1"),
                              self.process([2.0], scene_ms="4"),
                              self.process([12.0], scene_ms="2")])
        expected = {"rounds": "3", "repeat": "4", "kernel_ms_median": "3.500000",
                    "kernel_ms_min": "1.000000", "kernel_ms_max": "12.000000",
                    "kernel_ms_low": "1.000000", "kernel_ms_high": "12.000000",
                    "kernel_ms_runs": "5.000000;1.000000;2.000000;12.000000",
                    "serial_ms_median": "1.750000", "serial_ms_max": "6.000000",
                    "other_ms_median": "0.750000", "compact_ms_median": "",
                    "scene_ms": "2.000000", "mpaths_per_s": "1.71429",
                    "mrays_per_s": "3.42857"}  # 6000 paths, 12000 rays in 3.5 ms; the mean is 5
        self.assertEqual({key: row[key] for key in expected}, expected)


class WholeProcesses(unittest.TestCase):
    def test_the_parts_add_up_by_hand(self):
        process = Process("measured", wall_ms=100.0, early_ms=3.0, runs=[{"kernel_ms": 20.0}], row={
            "kernel_ms_median": "20", "process_start_ms": "8", "process_scene_ms": "30",
            "process_render_ms": "25", "process_image_ms": "4", "process_total_ms": "67"})
        self.assertEqual(list(pooling.parts_of(process).items()), [
            ("start", 5.0), ("scene", 30.0), ("kernels", 20.0), ("render_rest", 5.0),
            ("image", 4.0), ("end", 36.0)])
        self.assertEqual(pooling.parts_of(Process("measured", wall_ms=9.0)), {"undivided": 9.0})

    def test_no_process_ends_before_its_last_word(self):
        """/proc counts an age in ticks of 10 ms, which made one in two end earlier."""
        with tempfile.TemporaryDirectory() as folder:
            script = Path(folder, "age.py")
            script.write_text(AGE, encoding="utf-8")
            command = [sys.executable, "-I", "-S", str(script)]
            ends = [pooling.parts_of(program.measure(command, 60))["end"] for _ in range(12)]
        self.assertGreaterEqual(min(ends), 0)

    def test_a_process_without_end(self):
        begin_s = time.monotonic()
        process = program.measure(["sleep", "60"], 0.2, renders=False)
        self.assertLess(time.monotonic() - begin_s, 30)
        self.assertEqual((process.status, process.message),
                         ("failed", "no end after 0.2 s (--timeout)"))
        self.assertEqual(program.measure(["sleep", "0"], 60, renders=False).status, "measured")


class PageCache(unittest.TestCase):
    def scene(self, where):
        folder = tempfile.mkdtemp(prefix="ptexp cache ", dir=where)
        self.addCleanup(shutil.rmtree, folder)
        Path(folder, "meshes").mkdir()
        for name in ("scene.xml", "meshes/one.ply"):
            Path(folder, name).write_bytes(bytes(20000))
        return str(Path(folder, "scene.xml"))

    def cached(self, scene):
        return list(map(page_cache.is_cached, provenance.files_beside(scene)))

    def test_files_leave_and_come_back(self):
        scene = self.scene(None)
        self.assertEqual(self.cached(scene), [True, True])  # written just now
        system = program.output_of("stat", "--file-system", "--format=%T", scene)
        if system == "tmpfs":
            self.skipTest("files are in memory alone")
        page_cache.drop(scene)
        self.assertEqual(self.cached(scene), [False, False])
        page_cache.fill(scene)
        self.assertEqual(self.cached(scene), [True, True])

    def test_what_stays_in_memory_is_refused(self):
        if not os.access("/dev/shm", os.W_OK):
            self.skipTest("no /dev/shm")
        with self.assertRaisesRegex(harness.Refused, "one.ply stays in the page cache"):
            page_cache.drop(self.scene("/dev/shm"))


class Harness(unittest.TestCase):
    way = []  # options

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="ptexp harness ")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.program = self.fake("a")

    def fake(self, name, **behaviour):
        """A program in a folder of its own."""
        program = self.folder / name / "ptexp"
        program.parent.mkdir(exist_ok=True)
        text = (HERE / "fake_ptexp.py").read_text(encoding="utf-8")
        program.write_text(f"#!{sys.executable} -SE\n{text}", encoding="utf-8")
        program.chmod(0o755)
        (program.parent / "behaviour.json").write_text(json.dumps(behaviour), encoding="utf-8")
        return program

    def log(self, word="measure", name="a"):
        """(seed, repeat) of the processes that the program was."""
        path = self.folder / name / "log"
        lines = path.read_text().splitlines() if path.exists() else []
        path.unlink(missing_ok=True)
        return [tuple(line.split()[1:3]) for line in lines if line.startswith(word)]

    def options(self, *more):
        return ["--ptexp", str(self.program), "--output", str(self.folder / "out"), "--warmup", "0",
                "--repeat", "2", "--rounds", "2", *self.way, *more]

    def run_seeds(self, *more, seeds=(1, 2, 3), group="", **facts):
        """(exit code, text printed, text of errors)"""
        experiment = Experiment("fake", "Fake?", lambda *_: [
            Configuration(f"seed {seed}", f"--seed {seed}", {"x": seed}, same_image=group)
            for seed in seeds], None, **facts)
        output, errors = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
            status = harness.main(experiment, self.options(*more))
        return status, output.getvalue(), errors.getvalue()

    def rows(self):
        path, = self.folder.glob("out/*/fake.csv")
        with open(path, newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def facts(self):
        path, = self.folder.glob("out/*/fake.json")
        return json.loads(path.read_text(encoding="utf-8"))

    def columns(self, name):
        return [row[name] for row in self.rows()]

    def test_rounds_take_turns(self):
        status, output, _ = self.run_seeds("--repeat", "5", "--rounds", "3")
        self.assertEqual(status, 0)
        self.assertEqual(self.log(), [("1", "2"), ("2", "2"), ("3", "2"), ("3", "2"), ("2", "2"),
                                      ("1", "2"), ("1", "1"), ("2", "1"), ("3", "1")])
        self.assertEqual(self.columns("repeat"), ["5"] * 3)
        self.assertEqual(self.columns("rounds"), ["3"] * 3)
        self.assertEqual([(state["round"], state["when"]) for state in self.facts()["rounds"]],
                         [(n, when) for n in range(3) for when in ("begin", "end")])
        self.assertRegex(output, r"(?m)^1/9  seed 1: 1 ms  \(about \d+ s left\)$")

    def test_fewer_repeats_than_rounds(self):
        self.run_seeds("--repeat", "1", "--rounds", "3", seeds=(7,))
        self.assertEqual(self.log(), [("7", "1")])
        self.assertEqual(self.columns("status"), ["measured"])

    def test_a_killed_run_goes_on(self):
        script = self.folder / "fake.py"
        script.write_text(SCRIPT.format(experiments=str(EXPERIMENTS)), encoding="utf-8")
        self.fake("a", kills=4)
        command = [sys.executable, script, *self.options()]
        run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
        self.assertEqual(run.returncode, -9, run.stderr)
        self.assertEqual(len(self.log()), 4)  # seed 3 in the second round
        self.assertEqual(self.columns("status"), ["pending", "pending", "measured"])
        self.assertEqual(self.columns("rounds"), ["1", "1", "2"])
        self.assertFalse(self.facts()["complete"])
        journal, = self.folder.glob("out/*/fake.journal")
        with open(journal, "a", encoding="utf-8") as file:
            file.write('{"event": "proc')  # cut off while it wrote
        self.fake("a")
        run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(self.log(), [("2", "1"), ("1", "1")])
        self.assertEqual(self.columns("status"), ["measured"] * 3)
        self.assertEqual(len(self.facts()["resumed"]), 1)
        self.assertEqual(list(self.folder.glob("out/*/*.journal")), [])

    def test_what_is_measured_again(self):
        self.run_seeds()
        self.assertEqual(len(self.log()), 6)
        self.assertEqual(self.run_seeds()[0], 0)
        self.assertEqual(self.log(), [])
        self.run_seeds("--fresh")
        self.assertEqual(len(self.log()), 6)
        self.run_seeds("--repeat", "4")
        self.assertEqual(len(self.log()), 6)
        self.fake("a", version="def")  # another commit
        self.run_seeds("--repeat", "4")
        self.assertEqual(len(self.log()), 6)

    def test_a_calibration_decides_nothing_unasked(self):
        self.run_seeds(seeds=(1,))  # a program that has none
        self.assertNotIn("--calibration", self.facts()["configurations"]["seed 1"])
        for asked, used in (((), "none"), (("--calibration", "auto"), "auto")):
            self.program = self.fake(f"with {used}", help="  --calibration auto|none|FILE [auto]")
            self.run_seeds("--fresh", *asked, seeds=(1,))
            self.assertIn(f"--calibration {used} ", self.facts()["configurations"]["seed 1"])
            self.assertEqual(self.facts()["device"]["calibration"], used)

    def test_a_build_that_counts_lanes_is_refused(self):
        self.fake("a", version="abc\nbuild Release with divergence counters, GNU")
        status, _, errors = self.run_seeds()
        self.assertEqual((status, len(errors.splitlines())), (2, 1), errors)
        self.assertIn("has divergence counters; expected a build without", errors)
        self.assertEqual(list(self.folder.glob("out/*/*")), [])
        self.assertEqual(harness.find_program(self.program, counts_lanes=True),
                         self.program.resolve())
        self.fake("b")
        self.assertEqual(self.compare_builds()[0], 2)
        self.fake("a")
        with self.assertRaisesRegex(harness.HarnessError, "expected a build with PTEXP_DIV"):
            harness.find_program(self.program, counts_lanes=True)

    def test_launchers_and_wall_times(self):
        (self.folder / "a" / "behaviour.json").write_text(json.dumps(
            {"times": {"1": [2.0, 6.0]}, "devices": [[3.0, 1.0], [5.0, 2.0]]}), encoding="utf-8")
        experiment = Experiment("fake", "Fake?", lambda *_: [
            Configuration("a", "--seed 1", launcher="env PTEXP_FAKE_WALL=1.5", same_image="one"),
            Configuration("b", "--seed 1", same_image="one")], None)
        with contextlib.redirect_stdout(io.StringIO()):
            self.assertEqual(harness.main(experiment, self.options("--repeat", "4")), 0)
        launched, plain = self.rows()
        self.assertEqual(launched["wall_ms_runs"], "3.000000;9.000000;3.000000;9.000000")
        self.assertEqual([launched[f"wall_ms_{part}"] for part in ("median", "low", "high")],
                         ["6.000000", "3.000000", "9.000000"])
        # The busiest device had 1.0 and 1.5 more than the mean.
        self.assertEqual((launched["units"], launched["uneven_ms_median"]), ("7", "1.250000"))
        self.assertEqual((plain["wall_ms_runs"], plain["units"]), ("", ""))
        self.assertIn("env PTEXP_FAKE_WALL=1.5", self.facts()["configurations"]["a"])

    def test_bad_answers(self):
        if self.way:
            self.skipTest("there are none")
        for text, said in (("garbage", "garbage"), ("{}", "{}"), ("[1]", "[1]"),
                           ('{"error": 1}', '{"error": 1}'), ("\n", "\\n")):
            with self.subTest(text=text):
                self.fake("a", answers={"2": text})
                status, output, _ = self.run_seeds("--fresh")
                self.assertEqual((status, self.columns("status")),
                                 (1, ["measured", "failed", "measured"]))
                self.assertIn(f"answered '{said}", output)
        self.fake("a", answers={"2": json.dumps({"error": "CUDA: broken", "exit_code": 2})})
        status, output, _ = self.run_seeds("--fresh")
        self.assertEqual(self.columns("message"), ["", "exit code 2: CUDA: broken", ""])
        self.assertIn("CUDA: broken; another process goes on", output)

    def test_where_the_wall_time_of_processes_went(self):
        self.fake("a", times={"1": [4.0]}, end_s=0.25, process={
            "start": 9, "scene": 7, "render": 11, "image": 2.5, "total": 29.5})
        prepared = []

        def refuse():
            raise harness.Refused("not cold")
        made = [Configuration("a", "--seed 1", repeat=2, prepare=partial(prepared.append, 1)),
                Configuration("command", "--list-devices", repeat=2, renders=False),
                Configuration("cold", "--seed 1", repeat=2, prepare=refuse)]
        experiment = Experiment("fake", "Fake?", lambda *_: made, None, whole_process=True)
        with contextlib.redirect_stdout(io.StringIO()):
            self.assertEqual(harness.main(experiment, self.options()), 0)
        row, command, cold = self.rows()
        walls = [float(wall) for wall in row["process_wall_ms_runs"].split(";")]
        self.assertEqual([float(row[f"process_wall_ms_{end}"]) for end in ("low", "high")],
                         [min(walls), max(walls)])
        self.assertAlmostEqual(float(row["process_wall_ms"]), sum(walls) / 2, places=5)
        self.assertGreater(min(walls), 250)
        parts = {part: float(row[f"process_{part}_ms"]) for part in (
            "start", "scene", "kernels", "render_rest", "image", "end")}
        self.assertEqual([parts[part] for part in ("scene", "kernels", "render_rest", "image")],
                         [7, 4, 7, 2.5])
        self.assertTrue(-2 < parts["start"] <= 9, parts)  # less a part of a tick
        # Each median is the mean of two processes, so these parts add up as well.
        self.assertAlmostEqual(sum(parts.values()), sum(walls) / 2, places=4)
        self.assertGreater(parts["end"], 250 - 29.5)
        self.assertEqual((row["process_render_ms"], row["process_total_ms"]),
                         ("11.000000", "29.500000"))  # as ptexp says them
        self.assertEqual(len(prepared), 2)
        self.assertEqual((command["process_undivided_ms"], command["kernel_ms_median"],
                          command["scene_hash"], command["repeat"]),
                         (command["process_wall_ms"], "", "", "2"))
        self.assertLess(float(command["process_wall_ms"]), min(walls))
        self.assertEqual(self.facts()["configurations"]["command"], "ptexp --list-devices")
        self.assertEqual((cold["status"], cold["message"]), ("refused", "not cold"))
        self.assertEqual(self.log(), [("1", "1")] * 2)

    def test_ctrl_c(self):
        self.fake("a", wrong={"2": 130})
        status, _, errors = self.run_seeds()
        self.assertEqual(status, 130)
        self.assertIn("the same command goes on", errors)
        self.assertEqual(self.columns("status"), ["pending"] * 3)
        self.assertEqual(self.columns("kernel_ms_median"), ["1.000000", "", ""])
        self.fake("a", version="def")  # another commit: nothing is taken over
        self.log()
        self.assertEqual(self.run_seeds()[0], 0)
        self.assertEqual(len(self.log()), 6)

    def test_a_failure_is_a_row(self):
        self.fake("a", wrong={"2": 11, "3": 2})
        status, _, errors = self.run_seeds()
        self.assertEqual(status, 1)
        self.assertIn("failed: seed 2: exit code 11: seed 2 is wrong", errors)
        self.assertEqual(self.columns("status"), ["measured", "failed", "refused"])
        self.assertEqual(self.columns("message"),
                         ["", "exit code 11: seed 2 is wrong", "seed 3 is wrong"])
        self.assertEqual(self.log(), [(seed, "1") for seed in "1231"])
        self.fake("a")  # it was the machine's fault
        self.assertEqual(self.run_seeds()[0], 0)
        self.assertEqual(self.log(), [("2", "1"), ("2", "1")])
        self.assertEqual(self.columns("status"), ["measured", "measured", "refused"])

    def test_a_crash_costs_one_configuration(self):
        for behaviour, message in (({"dies": {"2": 9}}, "ended by signal 9"),
                                   ({"dies": {"2": 11}}, "ended by signal 11"),
                                   ({"hangs": ["2"]}, "no end after 2 s (--timeout)")):
            with self.subTest(message=message):
                self.fake("a", **behaviour)
                status, output, errors = self.run_seeds("--fresh", "--timeout", "2")
                self.assertEqual(status, 1)
                self.assertIn(f"failed: seed 2: {message}", errors)
                self.assertEqual(self.columns("status"), ["measured", "failed", "measured"])
                self.assertEqual(self.log(), [(seed, "1") for seed in "12331"])
                self.assertEqual(f"ptexp measure: {message}; another process goes on" in output,
                                 not self.way)

    def processes(self):
        """The number of those that measured."""
        lines = (self.folder / "a" / "log").read_text(encoding="utf-8").splitlines()
        self.log()
        return len({line.split()[-1] for line in lines if line.startswith("measure")})

    def test_which_way_measured(self):
        self.run_seeds("--fresh")
        self.assertEqual(self.processes(), 6 if self.way else 1)
        by = self.facts()["measured_by"]
        self.assertEqual(by, "a process for each" if self.way else "one process")
        for facts in ({"whole_process": True}, {"own": {"launcher": "env A=1"}},
                      {"own": {"program": str(self.program)}}):
            with self.subTest(facts=facts):
                own = facts.pop("own", {})
                made = [Configuration("a", "--seed 1"), Configuration("b", "--seed 2", **own)]
                with contextlib.redirect_stdout(io.StringIO()):
                    self.assertEqual(harness.main(Experiment("fake", "Fake?", lambda *_, made=made: made,
                                                             None, **facts),
                                                  self.options("--fresh")), 0)
                self.assertEqual(self.processes(), 4)
                self.assertEqual(self.facts()["measured_by"], "a process for each")

    def test_a_kept_image(self):
        image = self.folder / "kept.exr"
        made = [Configuration("a", "--seed 1", image=str(image)), Configuration("b", "--seed 2")]
        with contextlib.redirect_stdout(io.StringIO()):
            self.assertEqual(harness.main(Experiment("fake", "Fake?", lambda *_: made, None),
                                          self.options()), 0)
        self.assertEqual(image.read_text(encoding="utf-8"), "same")

    def test_equal_images(self):
        status, _, errors = self.run_seeds(group="all", image_check="--width 7 --seed 5")
        self.assertEqual((status, errors), (0, ""))
        self.assertEqual(self.log("check"), [("5", "7")])  # one and the same command
        self.assertEqual(self.facts()["equal_images"], {"all": ["seed 1", "seed 2", "seed 3"]})

    def test_unequal_images_are_refused(self):
        self.fake("a", images={"3": "other"})
        status, _, errors = self.run_seeds(group="all")
        self.assertEqual((status, len(errors.splitlines())), (2, 1), errors)
        self.assertIn("images of seed 3 and seed 1 differ in 3 pixels", errors)
        self.assertEqual(self.log(), [])
        self.assertEqual(list(self.folder.glob("out/*/*.csv")), [])

    def test_images_that_fail(self):
        self.fake("a", wrong={"1": 2, "2": 11})
        status, _, _ = self.run_seeds(group="all")
        self.assertEqual(status, 1)
        self.assertEqual(self.columns("status"), ["refused", "failed", "measured"])
        self.assertIn("image check", self.rows()[1]["message"])

    def test_options_of_images(self):
        self.assertEqual(with_options("--spp 9 --scene 'a b' --strict --width 3",
                                      "--width 1 --spp 2"),
                         ["--scene", "a b", "--strict", "--width", "1", "--spp", "2"])

    def test_scene_hashes(self):
        folder = self.folder / "scene"
        folder.mkdir()
        (folder / "scene.xml").write_text("<scene/>")
        (folder / "texture.png").write_text("red")
        arguments = f"--spp 1 --scene '{folder / 'scene.xml'}'"

        def found():
            provenance.folder_hash.cache_clear()
            return provenance.scene_hash(arguments)
        before = found()
        self.assertRegex(before, "^sha256 [0-9a-f]{16}$")
        self.assertEqual(found(), before)
        (folder / "texture.png").write_text("blue")
        self.assertNotEqual(found(), before)
        # A scene may lie in a folder of temporary files.
        with mock.patch.object(provenance, "files_beside", lambda _: [folder / "gone.tmp"]):
            self.assertRegex(found(), "^sha256 [0-9a-f]{16}$")
        self.assertEqual(provenance.scene_hash("--spp 1"), "built-in spheres")
        self.assertEqual(provenance.scene_hash("--scene statue:1M"), "built-in statue:1M")

    def test_time_left(self):
        self.assertEqual([rounds.left_text(seconds) for seconds in (0.2, 42, 200, 9000)],
                         ["about 1 s left", "about 42 s left", "about 3 min left",
                          "about 2.5 h left"])

    def compare_builds(self, *more):
        compare = importlib.import_module("compare_builds")
        output = io.StringIO()
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output), \
                mock.patch.object(compare, "SCENES", {"spheres": "--scene spheres"}):
            status = harness.main(compare.EXPERIMENT, [
                str(self.program), str(self.folder / "b" / "ptexp"), "--quick", "--repeat", "6",
                "--rounds", "2", "--output", str(self.folder / "out"), *more], runner=compare.run)
        return status, output.getvalue()

    def test_builds(self):
        times = [1.0, 1.01, 0.99]
        self.fake("a", times={"": times})
        self.fake("b", times={"": [1.1 * time for time in times]}, version="b")
        status, output = self.compare_builds()
        self.assertEqual(status, 1, output)
        self.assertIn("B takes 1.1000 times as long as A", output)
        self.assertIn("slower by more than 2 %: spheres: megakernel, spheres: wavefront", output)
        self.fake("b", times={"": times}, version="c")
        status, output = self.compare_builds()
        self.assertEqual(status, 0, output)
        self.assertIn("(geometric mean of 2; ", output)
        self.assertIn("no significant difference", output)
        self.assertIn("slower by more than 2 %: none", output)
        self.fake("b", images={"": "other"}, version="d")
        self.assertEqual(self.compare_builds()[0], 2)

    def test_verdicts_on_builds(self):
        compare = importlib.import_module("compare_builds")
        for low, high, verdict in ((1.03, 1.5, "SLOWER"), (1.01, 1.5, "slower"),
                                   (0.99, 1.5, "no significant difference"),
                                   (0.5, 0.99, "faster"), (1.03, 1.04, "SLOWER")):
            self.assertEqual(compare.verdict_of(low, high), verdict, (low, high))
        # 4 times as slow and a quarter of the time cancel: an arithmetic mean has 2.1250.
        self.assertAlmostEqual(compare.mean_ratio([[1.0], [4.0], [4.0], [1.0]]), 1)
        self.assertAlmostEqual(compare.mean_ratio([[1.0], [8.0], [4.0], [8.0]]), 4)

    def test_two_ways_to_measure(self):
        if self.way:
            self.skipTest("both are in it")
        compare = importlib.import_module("compare_builds")

        def ways(*more):
            output = io.StringIO()
            with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output), \
                    mock.patch.object(compare, "WAYS_SCENES", {"spheres": "--scene spheres"}):
                status = harness.main(compare.EXPERIMENT, [
                    str(self.program), "--quick", "--repeat", "4", "--rounds", "2", "--warmup", "0",
                    "--output", str(self.folder / "out"), "--fresh", *more], runner=compare.run)
            return status, output.getvalue()
        times = {"": [1.0, 1.001]}
        self.fake("a", times=times, factor=1.005)
        status, output = ways("--one-process")
        self.assertEqual(status, 0, output)
        self.assertIn("are 1.0050 times those of single processes (geometric mean of 6; ", output)
        self.assertIn("equal within 1 %: 6 of 6; ambiguous: none", output)
        path, = self.folder.glob("out/*/compare_builds-quick.json")
        self.assertEqual(json.loads(path.read_text(encoding="utf-8"))["measured_by"],
                         "a process for each and one process")
        self.assertEqual(self.processes(), 1 + 6 * 2)
        self.fake("a", times=times, factor=1.02)
        status, output = ways("--one-process")
        self.assertEqual(status, 1, output)
        self.assertRegex(output, "different by more than 1 %: spheres: megakernel, spheres: mega")
        status, output = ways()
        self.assertEqual((status, output.count("\n")), (2, 1))
        self.assertIn("expected two programs, or one and --one-process", output)
        for low, high, verdict in ((0.995, 1.005, "equal"), (0.98, 1.0, "ambiguous"),
                                   (1.0, 1.02, "ambiguous"), (1.011, 1.02, "DIFFERENT"),
                                   (0.97, 0.989, "DIFFERENT")):
            self.assertEqual(compare.verdict_of(low, high, True), verdict, (low, high))

    def trace(self, _experiment, _program, rays, *_):
        """Stands for the measurement of a set of rays; Ctrl-C at the third."""
        name = Path(rays.rays).name
        self.traced.append(name)
        if len(self.traced) == 3:
            raise KeyboardInterrupt
        return [{"status": "measured", "ray_file": name, "accel": "", "builder": "", "variant": "",
                 "mrays_per_s": "1"}]

    def test_ray_sets_go_on(self):
        ray_sets, traced_sets = map(importlib.import_module, ("ray_sets", "lib.traced_sets"))
        self.traced = []

        def run():
            with contextlib.redirect_stdout(io.StringIO()), \
                    contextlib.redirect_stderr(io.StringIO()), \
                    mock.patch.object(traced_sets, "measure", self.trace):
                return harness.main(ray_sets.EXPERIMENT, self.options("--quick"), runner=partial(
                    traced_sets.run, sets_of=ray_sets.ray_sets))
        self.assertEqual(run(), 130)
        path, = self.folder.glob("out/*/ray_sets-quick.csv")
        self.assertEqual(len(path.read_text().splitlines()), 1 + 2)
        self.assertEqual(run(), 0)
        self.assertEqual(len(path.read_text().splitlines()), 1 + 6)
        self.assertEqual(self.traced[2], self.traced[3])  # the one that was cut off
        self.assertEqual(len(self.traced), 6 + 1)
        self.assertEqual(run(), 0)
        self.assertEqual(len(self.traced), 6 + 1)  # a complete table is not measured again

    def test_compaction_is_measured_once(self):
        compaction = importlib.import_module("compaction")
        names = []

        def measure(_program, name, *_):
            names.append(name)
            return [{"status": "measured", "name": name, "series": "scan", "cache": "warm",
                     "strategy": "scan", "time_ms": "1", "gb_per_s": "1", "copy_share": "1"}]

        def run(*more):
            with contextlib.redirect_stdout(io.StringIO()), \
                    mock.patch.object(compaction, "measure", measure), \
                    mock.patch.object(harness, "draw", lambda path: ""):
                return harness.main(compaction.EXPERIMENT, self.options("--quick", *more),
                                    runner=compaction.run)
        self.assertEqual((run(), run()), (0, 0))
        self.assertEqual(len(names), 2)
        self.assertEqual(run("--fresh"), 0)
        self.assertEqual(len(names), 4)

    def test_a_missing_matplotlib_is_one_line(self):
        (self.folder / "matplotlib.py").write_text("raise ImportError('none here')\n")
        run = subprocess.run([sys.executable, EXPERIMENTS / "plot.py", "a.csv"], text=True,
                             env={"PYTHONPATH": str(self.folder)}, capture_output=True, check=False)
        self.assertEqual((run.returncode, len(run.stderr.splitlines())), (1, 1), run.stderr)
        self.assertIn("plot.py: error: none here; experiments/README.md says", run.stderr)

    def test_titles_of_quick_plots_give_no_full_size(self):
        title_of = importlib.import_module("lib.sentences").plot_title
        facts = {"plot": {"title": "Toggles: spheres, 600x300, 50 samples"}, "quick": False}
        self.assertEqual(title_of(facts), "Toggles: spheres, 600x300, 50 samples")
        for path in sorted(EXPERIMENTS.glob("*.py")):
            if "harness.main(" in path.read_text(encoding="utf-8"):
                plot = importlib.import_module(path.stem).EXPERIMENT.plot
                if plot:
                    title = title_of({"plot": {"title": plot.title}, "quick": True})
                    self.assertNotRegex(title, r"\d+ ?x ?\d+|\d samples|depth", path.stem)
                    self.assertIn("quick", title)

    def test_intervals_are_drawn(self):
        try:
            plot = importlib.import_module("lib.plot")
        except ImportError:
            self.skipTest("matplotlib is not installed")
        row = {"t_median": "3", "t_min": "1", "t_max": "9"}
        self.assertEqual(plot.spread([row], "t"), ([3], [[2], [6]]))
        self.assertEqual(plot.spread([{**row, "t_low": "2.5", "t_high": "4"}], "t"),
                         ([3], [[0.5], [1]]))


class SingleProcesses(Harness):
    """All of it once more, with a process for each configuration."""
    way = ["--single-processes"]


if __name__ == "__main__":
    unittest.main()
