"""Runs the experiments' harness with small images on the CPU: tables, refusals, failures, plots.

The environment variable PTEXP names the executable (build/release/src/ptexp).
"""
import argparse
import contextlib
import csv
import importlib
import io
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import threading
import types
import unittest
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).resolve().parents[2]
PTEXP = Path(os.environ.get("PTEXP", ROOT / "build" / "release" / "src" / "ptexp")).resolve()
TIMEOUT_S = 600  # generous, because the sanitizers share a busy machine
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "experiments"))
from lib import harness  # noqa: E402
from lib import pooling  # noqa: E402
from lib import program  # noqa: E402
from lib import resident  # noqa: E402
from lib import scene_files  # noqa: E402
from lib import table  # noqa: E402
from lib.harness import Configuration, Experiment, Plot  # noqa: E402
from lib.options import parse_arguments  # noqa: E402

SCRIPTS = sorted(path.stem for path in (ROOT / "experiments").glob("*.py")
                 if "harness.main(" in path.read_text(encoding="utf-8"))
NEED_GPU = ["block_size", "counters", "gpu_size", "hardware", "law"]
GPU_IN_PART = ["scene_memory"]  # more than half of its rows are refused on a CPU
NEED_TWO_BUILDS = ["compare_builds"]  # test_harness.py runs it
NEED_COUNTING_BUILD = ["divergence"]

IMAGE = "--width 24 --height 12 --spp 2"


def tiny_configurations(_arguments, _device):
    return [Configuration("small", f"--mode serial {IMAGE}", {"series": "a", "panel": "", "x": 1}),
            Configuration("64x64", f"--mode megakernel --block 64x64 {IMAGE}",
                          {"series": "a", "panel": "", "x": 2}),
            Configuration("larger", f"--mode wavefront {IMAGE} --seed 7",
                          {"series": "a", "panel": "", "x": 3}, repeat=1)]


TINY = Experiment("tiny", "Tiny: does the harness work?", tiny_configurations,
                  Plot("lines", "Tiny", "x"))

# Stands for a ptexp that dies while it renders.
CRASHING = """#!/bin/sh
case "$1" in
  --list-devices) echo 'cpu        CPU (2 threads)' ;;
  --version) echo 'ptexp 0' ;;
  *) kill -SEGV $$ ;;
esac
"""


class PythonScenes(unittest.TestCase):
    """What a Python file makes in memory is rendered by Python, whatever the experiment."""

    def configurations_of(self, name, scene):
        experiment = importlib.import_module(name).EXPERIMENT
        device = types.SimpleNamespace(choice="cuda:0", kind="cuda", gpus=1, calibration="none", name="GPU",
                                       multiprocessors=132)
        with tempfile.TemporaryDirectory(prefix="ptexp ") as folder, \
                mock.patch.object(harness, "find_program", return_value=PTEXP), \
                mock.patch.object(harness, "find_device", return_value=device), \
                mock.patch.object(harness, "key_of", return_value=""):
            arguments = parse_arguments(experiment, ["--scenes", scene, "--output", folder])
            return harness.session_of(experiment, arguments).configurations

    def test_every_experiment_that_takes_scene_files(self):
        takers = [name for name in SCRIPTS if "add_scene_files" in
                  (ROOT / "experiments" / f"{name}.py").read_text(encoding="utf-8")]
        self.assertGreater(len(takers), 9)
        for name in takers:
            with self.subTest(name):
                for scene, is_python in (("/my scenes/own.py", True), ("/my scenes/own.xml", False)):
                    own = [c for c in self.configurations_of(name, scene) if "/my scenes/" in c.arguments]
                    self.assertTrue(own)
                    for configuration in own:
                        words = harness.shlex.split(configuration.arguments)
                        self.assertIn(scene, words, configuration.arguments)
                        self.assertEqual(Path(configuration.program).name, "python_scene.py" if is_python else "")

    def test_beside_a_launcher_and_another_program(self):
        make = Configuration("a", "--scene own.py", launcher="env A=1")
        self.assertEqual(scene_files.by_python(make).launcher, f"env A=1 {sys.executable}")
        self.assertEqual(make.program, "")
        with self.assertRaisesRegex(harness.HarnessError, "own.py: expected a scene file that ptexp reads"):
            scene_files.by_python(Configuration("a", "--scene own.py", program="/usr/bin/other"))
        tells = Configuration("a", "--scene own.py", renders=False)
        self.assertIs(scene_files.by_python(tells), tells)


class Experiments(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="ptexp experiments ")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_tiny(self, *arguments, experiment=TINY):
        """(exit code, text printed, text of errors)"""
        command = ["--ptexp", str(PTEXP), "--device", "cpu", "--output", str(self.folder / "out"),
                   "--repeat", "3", "--warmup", "1", "--rounds", "1", *arguments]
        output, errors = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
            status = harness.main(experiment, command)
        return status, output.getvalue(), errors.getvalue()

    def result(self, ending="csv", name="tiny"):
        found, = self.folder.glob(f"out/*/{name}.{ending}")
        return found

    def rows(self, name="tiny"):
        with open(self.result("csv", name), newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def files(self):
        return {path.name: path.read_bytes() for path in self.folder.glob("out/*/*")}

    def test_a_table(self):
        status, output, errors = self.run_tiny("--rounds", "2")
        self.assertEqual((status, errors), (0, ""), output)
        rows = self.rows()
        self.assertEqual([row["name"] for row in rows], ["small", "64x64", "larger"])
        self.assertEqual([row["status"] for row in rows], ["measured", "refused", "measured"])
        for row in (rows[0], rows[2]):
            times = [float(row[f"kernel_ms_{part}"])
                     for part in ("min", "low", "median", "high", "max")]
            self.assertTrue(0 < times[0] and times == sorted(times), times)
            self.assertEqual(len(row["kernel_ms_runs"].split(";")), int(row["repeat"]))
            self.assertEqual(row["scene_hash"], "built-in spheres")
            self.assertEqual((row["width"], row["paths"]), ("24", str(24 * 12 * 2)))
        self.assertEqual([row["repeat"] for row in rows], ["3", "", "1"])
        self.assertIn("1,024", rows[1]["message"])
        self.assertEqual((rows[1]["kernel_ms_median"], rows[1]["x"]), ("", "2"))
        self.assertIn("refused", output)

    def test_one_process_is_pooled_as_ptexp_does(self):
        device = harness.find_device(PTEXP, "cpu")
        for mode in ("serial", "wavefront"):
            one = Configuration("", f"--mode {mode} {IMAGE} --scene statue:1K")
            process = program.measure(program.command_line(PTEXP, one, device, 4, 0), TIMEOUT_S)
            row = pooling.pooled([process])
            for column, value in process.row.items():
                with self.subTest(column=column):
                    if column.endswith(("_ms_median", "_ms", "_per_s")) and value:
                        # The rates have six digits.
                        self.assertAlmostEqual(float(row[column]) / max(float(value), 1e-9), 1,
                                               delta=1e-5 if float(value) else 1)
                    else:
                        self.assertEqual(row[column], value)

    def test_both_ways_give_the_same_table(self):
        tables = []
        for way in ([], ["--single-processes"]):
            status, output, errors = self.run_tiny(*way, "--rounds", "2", "--fresh")
            self.assertEqual((status, errors), (0, ""), output)
            facts = json.loads(self.result("json").read_text(encoding="utf-8"))
            self.assertEqual(facts["measured_by"], resident.EACH if way else resident.ONE)
            self.assertIn(facts["measured_by"], output)
            changes = "_ms$|_ms_|_per_s$|launches$|^waves$|^output$|^used_exposure$|^csv$|^stats$"
            tables.append([{column: text for column, text in row.items()
                            if not re.search(changes, column)} for row in self.rows()])
        self.assertEqual(*tables)

    def test_a_killed_process_costs_one_configuration(self):
        device = harness.find_device(PTEXP, "cpu")
        small, long = (Configuration("", f"--mode megakernel --width 24 --height 12 --spp {spp}")
                       for spp in (2, 100_000_000))
        with resident.Resident(PTEXP) as process, contextlib.redirect_stdout(io.StringIO()):
            measured = process.measure(small, device, 2, 0, TIMEOUT_S)
            self.assertEqual((measured.status, len(measured.runs)), ("measured", 2))
            threading.Timer(0.5, process.process.kill).start()
            lost = process.measure(long, device, 1, 0, TIMEOUT_S)
            self.assertEqual((lost.status, lost.message), ("failed", "ended by signal 9"))
            lost = process.measure(long, device, 1, 0, 0.5)
            self.assertEqual((lost.status, lost.message), ("failed", "no end after 0.5 s (--timeout)"))
            refused = process.measure(Configuration("", "--block 64x64"), device, 1, 0, TIMEOUT_S)
            self.assertEqual(refused.status, "refused")
            self.assertEqual(process.measure(small, device, 2, 0, TIMEOUT_S).status, "measured")

    def test_the_origin_of_a_table(self):
        self.run_tiny()
        facts = json.loads(self.result("json").read_text(encoding="utf-8"))
        self.assertEqual(facts["device"]["choice"], "cpu")
        self.assertIn("--block 64x64", facts["configurations"]["64x64"])
        for key in ("command", "date", "program", "host"):
            self.assertTrue(facts[key], key)

    def test_nothing_else_is_left(self):
        self.run_tiny()
        self.assertLessEqual(set(self.files()), {"tiny.csv", "tiny.json", "tiny.png"})

    def test_a_label_keeps_the_other_table(self):
        self.run_tiny()
        before = self.result().read_bytes()
        status, _, _ = self.run_tiny("--label", "fast-math")
        self.assertEqual((status, self.result().read_bytes()), (0, before))
        self.assertEqual(len(self.rows("tiny-fast-math")), 3)

    def test_a_failed_run_leaves_the_result_intact(self):
        self.run_tiny()
        before = self.files()
        crashing = self.folder / "crashing"
        crashing.write_text(CRASHING, encoding="utf-8")
        crashing.chmod(0o755)
        status, _, errors = self.run_tiny("--ptexp", str(crashing))
        self.assertEqual((status, len(errors.splitlines())), (2, 1), errors)
        self.assertIn("no result was written", errors)
        self.assertEqual(self.files(), before)

    def test_nothing_but_refusals_is_an_error(self):
        refused = Experiment("tiny", "?", lambda *_: tiny_configurations(*_)[1:2], TINY.plot)
        status, _, errors = self.run_tiny(experiment=refused)
        self.assertEqual(status, 2)
        self.assertIn("64x64", errors)
        self.assertEqual(self.files(), {})

    def test_a_missing_program_or_device(self):
        for arguments in (["--ptexp", str(self.folder / "none")], ["--device", "cuda:99"]):
            status, _, errors = self.run_tiny(*arguments)
            self.assertEqual((status, len(errors.splitlines())), (2, 1), errors)
            self.assertIn(arguments[1], errors)

    def test_a_failed_write_leaves_the_file(self):
        path = self.folder / "table.csv"
        table.write_atomically(path, "old")
        with self.assertRaises(TypeError):
            table.write_atomically(path, b"not text")
        self.assertEqual(path.read_text(encoding="utf-8"), "old")
        self.assertEqual([path], list(self.folder.iterdir()))

    def test_the_plot(self):
        try:
            importlib.import_module("matplotlib")
        except ImportError:
            _, output, _ = self.run_tiny()
            self.assertIn("no plot", output)
            self.skipTest("matplotlib is not installed")
        self.run_tiny()
        self.assertEqual(self.result("png").read_bytes()[:8], b"\x89PNG\r\n\x1a\n")

    def test_the_experiments_run(self):
        for script in [script for script in SCRIPTS if script not in NEED_TWO_BUILDS]:
            with self.subTest(script=script):
                self.check_script(script)

    def test_compaction_is_judged_where_it_is_large_and_cold(self):
        compaction = importlib.import_module("compaction")

        def verdicts(*rows):
            return compaction.conclude([
                {"series": f"{strategy}, 1 queue", "strategy": strategy, "cache": cache,
                 "items": str(items), "copy_share": str(share), "time_ms": "0.0125"}
                for strategy, cache, items, share in rows])
        self.assertEqual(verdicts(("cub", "warm", 1 << 24, 0.1), ("none", "cold", 1 << 24, 0.1)),
                         [])
        large = [("cub", "cold", 1 << 24, 0.8), ("cub", "cold", 1 << 25, 0.95)]
        self.assertEqual(verdicts(*large), ["cub, 1 queue: 80 to 95 % of a copy's bandwidth from "
                                            "16 M items on (target 80 %: reached)"])
        self.assertIn("MISS", verdicts(*large, ("cub", "cold", 1 << 26, 0.79))[0])
        self.assertEqual(verdicts(("atomic", "cold", 1 << 20, 0.1), ("atomic", "cold", 1 << 22, 0)),
                         ["atomic, 1 queue: 12.5 to 12.5 us below 4 M items"])

    def check_script(self, script):
        run = subprocess.run(
            [sys.executable, ROOT / "experiments" / f"{script}.py", "--quick", "--device", "cpu",
             "--repeat", "2", "--rounds", "1", "--warmup", "0", "--ptexp", PTEXP,
             "--output", self.folder / "out"],
            capture_output=True, text=True, check=False, timeout=TIMEOUT_S)
        if script in NEED_COUNTING_BUILD:
            self.assertEqual(run.returncode, 2, run.stdout + run.stderr)
            self.assertIn("expected a build with PTEXP_DIVERGENCE=ON", run.stderr)
            return
        if script in NEED_GPU:
            self.assertEqual(run.returncode, 2, run.stdout + run.stderr)
            self.assertIn("needs a GPU, and --device cpu is a CPU", run.stderr)
            return
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        rows = self.rows(f"{script}-quick")
        self.assertTrue(all(row["experiment"] == script for row in rows))
        measured = [row for row in rows if row["status"] == "measured"]
        self.assertGreater(len(measured), 0 if script in GPU_IN_PART else len(rows) / 2)
        self.check_counts(script, measured)

    def check_counts(self, script, rows):
        """What an experiment's columns say must follow from what ptexp counted."""
        if script == "compaction":
            self.assertEqual({row["strategy"] for row in rows}, {"cub", "scan", "atomic", "none"})
            for row in rows:
                gathered = 0 if row["strategy"] == "none" else int(row["waiting"])
                self.assertEqual(int(row["bytes"]), int(row["x"]) + 4 * gathered, row["name"])
        if script == "growth":
            counts = {"samples": "spp", "spheres": "primitives", "triangles": "triangles",
                      "lights": "lights"}
            for row in rows:
                pixels = int(row["width"]) * int(row["height"])
                counted = int(row[counts[row["panel"]]]) if row["panel"] in counts else pixels
                expected = int(row["x"]) + (row["panel"] == "spheres")  # and the ground
                self.assertAlmostEqual(counted / expected, 1, delta=0.1 * (
                    row["panel"] == "triangles"), msg=row["name"])
        if script == "depth":
            for row in rows:
                alive = list(map(float, row["alive"].split(";")))
                self.assertEqual((alive[0], len(alive) <= int(row["max_depth"])), (1, True))
                self.assertAlmostEqual(sum(alive), float(row["rays_per_path"]), delta=2e-3)
        if script == "metropolis":
            compared = [row for row in rows if row["x"]]
            self.assertEqual(len(compared), 3 * 2 * 2)
            for row in compared:
                self.assertEqual((row["seeds"], row["references"] != ""), ("3", True), row["name"])
                for label in ("rmse", "relmse", "flip"):
                    low, middle, high = (float(row[f"{label}_{end}"])
                                         for end in ("low", "median", "high"))
                    self.assertTrue(0 < low <= middle <= high, (row["name"], label))
                is_mlt = row["series"] == "mlt"
                self.assertEqual(row["gain_median"] != "", is_mlt, row["name"])
                self.assertEqual(row["integrator"] == "mlt", is_mlt, row["name"])
            pictures = {path.name for path in self.folder.glob("out/*/metropolis-quick-*.png")}
            self.assertEqual(len(pictures), 2 * 2 * 2)
        if script == "process_time":
            plot = json.loads(self.result("json", "process_time-quick").read_text())["plot"]
            for row in rows:  # one process each, so that its parts add up
                wall, total = float(row["process_wall_ms"]), float(row["process_total_ms"] or 0)
                parts = [float(row[column]) for column, _ in plot["parts"] if row[column]]
                self.assertAlmostEqual(sum(parts), wall, delta=1e-4, msg=row["name"])
                self.assertGreater(min(parts), -0.5, row["name"])
                self.assertGreater(wall, total - 10, row["name"])  # a tick
                self.assertEqual(row["process_kernels_ms"], row["kernel_ms_median"], row["name"])
            self.assertEqual({row["output"] for row in rows}, {"", "image.png"})
        if script == "random_numbers":
            errors = {}
            for row in rows:
                errors.setdefault(row["x"], set()).add(row["relmse"])
            self.assertEqual(set(map(len, errors.values())), {1})  # equal images, equal errors
            self.assertTrue(all((row["rng"] == "xorwow") == (row["set_up_ms"] != "")
                                for row in rows))

    def test_scaling_in_the_report(self):
        """A small table of devices of the CPU, measured, predicted, judged and shown."""
        run = subprocess.run(
            [sys.executable, ROOT / "experiments" / "scaling.py", "--device", "cpu", "--ptexp", PTEXP,
             "--devices", "1,2,3", "--threads", "1", "--repeat", "3", "--rounds", "1", "--warmup", "0",
             "--image", "--scene cornell --width 32 --height 24 --mode wavefront", "--spp", "4",
             "--output", self.folder / "out"],
            capture_output=True, text=True, check=False, timeout=TIMEOUT_S)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        for row in self.rows("scaling"):
            is_predicted = row["panel"] == "strong" and row["x"] != "1"
            self.assertEqual(row["predicted"] != "", is_predicted, row["name"])
            self.assertTrue(not is_predicted or 0 < float(row["predicted"]) <= 1, row["predicted"])
            walls = [float(wall) for wall in row["wall_ms_runs"].split(";")]
            self.assertAlmostEqual(sorted(walls)[1], float(row["wall_ms_median"]), places=5)
        folder = self.result(name="scaling").parent
        subprocess.run([sys.executable, ROOT / "scripts" / "report", folder], check=True,
                       capture_output=True)
        text = (folder / "report.html").read_text(encoding="utf-8")
        answer = text[text.index("What do several devices give"):].partition("</article>")[0]
        self.assertIn("One image (cornell, 32x24, 4 samples)", answer)
        self.assertIn("3 devices", answer)

    def test_every_experiment_has_its_files(self):
        self.assertLessEqual({"block_size", "image_size", "speed_targets", "toggles"}, set(SCRIPTS))
        readme = (ROOT / "experiments" / "README.md").read_text(encoding="utf-8")
        for script in SCRIPTS:
            self.assertIn(f"`{script}.py`", readme)
            self.assertTrue(os.access(ROOT / "experiments" / f"{script}.py", os.X_OK), script)


class PathState(unittest.TestCase):
    def setUp(self):
        self.path_state = importlib.import_module("path_state")

    def configurations(self, kind, *options):
        parser = argparse.ArgumentParser()
        self.path_state.add_arguments(parser)
        arguments = parser.parse_args(options)
        arguments.quick = False
        return self.path_state.configurations(arguments, types.SimpleNamespace(kind=kind))

    def rows(self, **times):
        """{mode: times with 0, 64 and 256 bytes}"""
        return [{"panel": "statue", "series": mode.replace("_", ", "), "x": str(size), "mode": mode,
                 "rays": "1000000", "kernel_ms_median": str(ms), "kernel_ms_min": str(ms - 0.1),
                 "kernel_ms_max": str(ms + 0.1), "kernel_ms_low": str(ms - 0.1),
                 "kernel_ms_high": str(ms + 0.1)}
                for mode, values in times.items() for size, ms in zip((0, 64, 256), values)]

    def test_all_promise_the_image_without_more_state(self):
        for kind, modes in (("cpu", 2), ("cuda", 4)):
            found = self.configurations(kind, "--bytes", "0", "48")
            self.assertEqual(len(found), 3 * modes * 2)
            self.assertEqual({one.same_image for one in found},
                             {"statue:1M", "dial:16:0:closed", "cornell"})
            for one in found:
                self.assertIn(f"--path-bytes {one.labels['x']}", one.arguments)
                self.assertNotIn("--counters", one.arguments)
        self.assertIn("--counters", self.configurations("cuda", "--counters")[0].arguments)
        self.assertNotIn("--counters", self.configurations("cpu", "--counters")[0].arguments)

    def test_from_which_size_on_another_mode_is_the_fastest(self):
        turn = self.path_state.turn_of
        self.assertEqual(turn(self.rows(megakernel=(1, 3, 8), wavefront=(2, 2.5, 4))),
                         "fastest with 0 bytes: megakernel; from 64 bytes on wavefront")
        self.assertEqual(turn(self.rows(megakernel=(1, 2, 3), wavefront=(2, 3, 4))),
                         "fastest with 0 bytes: megakernel; the same to 256 bytes")
        # Not where the intervals overlap.
        self.assertEqual(turn(self.rows(megakernel=(1, 2.55, 3), wavefront=(2, 2.5, 3.05))),
                         "fastest with 0 bytes: megakernel; the same to 256 bytes")

    def test_conclusions_say_what_bytes_cost(self):
        lines = self.path_state.conclude(self.rows(wavefront=(2, 3, 6)), None)
        self.assertEqual(lines[1], "statue, wavefront: 256 more bytes are 3.00 times as slow as "
                                   "without, 4.00 ns a ray")

    def test_kernels_and_counters_become_columns(self):
        row, = self.rows(wavefront=(1,))
        row.update(kernels="generate:32:0:0:256:1;shade_surface:96:16:1024:640:0.31",
                   counted_rays="10", counted_l2_read_bytes="1000", counted_l2_written_bytes="500",
                   counted_predicted_read_bytes="700", counted_predicted_written_bytes="300")
        self.path_state.finish([row], None)
        self.assertEqual([row[name] for name in self.path_state.OWN], ["96", "16", "100", "150"])
        of_cpu, = self.rows(wavefront=(1,))
        of_cpu.update(dict.fromkeys(self.path_state.OWN, ""))
        self.path_state.finish([of_cpu], None)
        self.assertEqual([of_cpu[name] for name in self.path_state.OWN], ["", "", "", ""])


class Dial(unittest.TestCase):
    def setUp(self):
        self.dial = importlib.import_module("dial")

    def test_crossings(self):
        crossing = self.dial.crossing
        self.assertEqual(crossing([(1, 1.1), (2, 1.0), (4, 1.3)]), 0)
        self.assertEqual(crossing([(1, 1.1), (2, 1.2), (4, 0.9)]), math.inf)
        self.assertAlmostEqual(crossing([(1, 0.5), (2, 0.8), (8, 1.2), (16, 1.4)]), 4)
        # What falls below once more has not crossed before.
        self.assertAlmostEqual(crossing([(1, 0.8), (2, 1.2), (4, 0.9), (8, 1.1)]), 4 * 2**0.5)

    def rows(self, **changes):
        counts = {"paths": "9", "rays": "30", "shadow_rays": "20", **changes}
        return [{"name": f"{variant} {materials}", "figure": "open", "materials": str(materials),
                 "coherence": "0", "series": "coherence 0", "variant": variant,
                 "kernel_ms_min": str(ms - 1), "kernel_ms_median": str(ms),
                 "kernel_ms_max": str(ms + 2), "kernel_ms_low": str(ms - 0.5),
                 "kernel_ms_high": str(ms + 1),
                 **(counts if variant != self.dial.BASE else {**counts, "rays": "30"})}
                for variant, times in ((self.dial.BASE, (10, 20)), ("uber", (20, 10)))
                for materials, ms in zip((1, 4), times)]

    def test_ratios_and_conclusions(self):
        rows = self.rows()
        self.dial.finish(rows, None)
        self.assertEqual([row["ratio_median"] for row in rows],
                         ["1.0000", "1.0000", "0.5000", "2.0000"])
        self.assertEqual((rows[2]["ratio_min"], rows[2]["ratio_max"]), ("0.4091", "0.6316"))
        self.assertEqual((rows[2]["ratio_low"], rows[2]["ratio_high"]), ("0.4524", "0.5641"))
        sentence, = self.dial.conclude(rows, None)
        self.assertEqual(sentence, "open, coherence 0, uber: crossover at about 1.6 materials,"
                         " 2.00 times as fast with 4")

    def test_other_paths_are_an_error(self):
        with self.assertRaisesRegex(harness.HarnessError, "31 rays"):
            self.dial.finish(self.rows(rays="31"), None)

    def test_variants_promise_one_image(self):
        arguments = types.SimpleNamespace(quick=False, size=8, spp=1, accel="bvh2",
                                          materials=[1, 4], coherences=[0, 0.5])
        for kind, fewer in (("cuda", 0), ("cpu", 3)):  # wide trees by warps are CUDA's
            groups = {}
            device = types.SimpleNamespace(kind=kind)
            for configuration in self.dial.configurations(arguments, device):
                groups.setdefault(configuration.same_image, []).append(configuration)
            self.assertEqual(set(map(len, groups.values())), {len(self.dial.VARIANTS) - fewer})


class Hardware(unittest.TestCase):
    def setUp(self):
        self.hardware = importlib.import_module("hardware")

    def rows(self, variant, **changes):
        counts = {"paths": "90", "rays": "900", "shadow_rays": "100", "kernels": "", "panel": "statue",
                  **{f"kernel_ms_{part}": "10" for part in ("min", "median", "max", "low", "high")}}
        slower = {f"kernel_ms_{part}": "20" for part in ("min", "median", "max", "low", "high")}
        return [{**counts, "name": "a", "variant": self.hardware.BASE},
                {**counts, **slower, "name": "b", "variant": variant, "intersect_ms_median": "5",
                 "shadow_ms_median": "5", **changes}]

    def ratio(self, variant, **changes):
        rows = self.rows(variant, **changes)
        self.hardware.finish(rows, None)
        return rows[1]["ratio_median"]

    def test_rows_whose_hits_are_others_are_compared_by_the_ray(self):
        self.assertEqual(self.ratio("custom"), "0.5000")
        for variant in ("any-hit", "built-in", "megakernel built-in, reorder"):
            self.assertEqual(self.ratio(variant), "0.5000")
            self.assertEqual(self.ratio(variant, rays="905", shadow_rays="101"), "0.5030")
            for changes, why in (({"rays": "910"}, "910 rays.* within 1%"),
                                 ({"shadow_rays": ""}, " shadow_rays.* within 1%"),
                                 ({"paths": "91"}, "91 paths.* equal numbers")):
                with self.assertRaisesRegex(harness.HarnessError, why):
                    self.ratio(variant, **changes)

    def test_rows_with_our_hits_have_our_rays(self):
        for variant in ("custom", "megakernel loop", "megakernel custom, reorder"):
            with self.assertRaisesRegex(harness.HarnessError, "901 rays.* equal numbers"):
                self.ratio(variant, rays="901")

    def test_speed_is_of_the_stages_that_trace(self):
        rows = self.rows("any-hit", rays="905")
        self.hardware.finish(rows, None)
        self.assertEqual(rows[1]["mrays_median"], "0.1005")

    def test_images_are_promised_where_our_test_decides(self):
        arguments = types.SimpleNamespace(quick=True)
        for one in self.hardware.configurations(arguments, None):
            own = "any-hit" in one.arguments or "built-in" in one.arguments
            self.assertEqual(one.same_image == "", own, one.arguments)


class Divergence(unittest.TestCase):
    def setUp(self):
        self.divergence = importlib.import_module("divergence")

    def statistics(self, rays=70):
        """Two full warps and one of six lanes trace camera rays; of two groups one is full."""
        def part(point, bounce, **groups):
            counts = [0] * 32
            for lanes, count in groups.items():
                counts[int(lanes[1:]) - 1] = count
            return {"point": point, "bounce": bounce, "lanes": counts}
        return {"counts": {"paths": 70, "rays": rays, "shadow_rays": 0}, "divergence": [
            part("generate", 0, n32=2, n6=1), part("intersect", 0, n32=2, n6=1),
            part("bsdf", 0, n32=1, n8=1), part("bsdf", 1, n4=2)]}

    def test_rows_by_hand(self):
        one = Configuration("room: m", "", {"scene": "room", "variant": "m"})
        rows = self.divergence.rows_of(one, self.statistics())
        found = [(row["point"], row["bounce"], row["x"], row["groups"], row["lanes"],
                  row["mean_lanes"], row["simt_efficiency"]) for row in rows]
        self.assertEqual(found, [("generate", 0, "", 3, 70, "23.3333", "0.72917"),
                                 ("intersect", 0, "", 3, 70, "23.3333", "0.72917"),
                                 ("bsdf", 0, 1, 2, 40, "20.0000", "0.62500"),
                                 ("bsdf", 1, 2, 2, 8, "4.0000", "0.12500")])
        self.assertEqual(rows[2]["groups_of"], "0;0;0;0;0;0;0;1" + ";0" * 23 + ";1")
        self.assertEqual(self.divergence.table_text(rows).splitlines(), [
            "mean lanes           all     0     1", "generate            23.3  23.3",
            "intersect           23.3  23.3", "bsdf                12.0  20.0   4.0"])
        self.assertFalse([column for column in rows[0] if "ms" in column])

    def test_rays_that_are_not_counted_are_an_error(self):
        self.divergence.check_sums("room", self.statistics())
        with self.assertRaisesRegex(harness.HarnessError, "70 lanes at intersect, but 71 rays"):
            self.divergence.check_sums("room", self.statistics(rays=71))
        statistics = self.statistics()
        statistics["counts"]["shadow_rays"] = 1
        with self.assertRaisesRegex(harness.HarnessError, "0 lanes at shadow, but 1 shadow_rays"):
            self.divergence.check_sums("room", statistics)


class Sampling(unittest.TestCase):
    def setUp(self):
        self.sampling = importlib.import_module("sampling")

    def rows(self, errors, kernel_ms="1000"):
        return [{"panel": "room", "series": way, "equal": equal, "relmse": str(error),
                 "kernel_ms_median": kernel_ms if equal == "time" else "9", "gain": ""}
                for way, of_way in errors.items() for equal, error in of_way.items()]

    def test_gains_and_verdicts(self):
        arguments = types.SimpleNamespace(seconds=1.0, quick=False)
        rows = self.rows({self.sampling.BEFORE: {"4 spp": 0.4, "time": 0.02},
                          self.sampling.UNIFORM: {"4 spp": 8, "time": 0.2},
                          self.sampling.BEST: {"4 spp": 0.2, "time": 0.005}})
        rows[-1]["kernel_ms_median"] = "1600"  # it took longer: 0.008 after a second
        self.sampling.fill_in_gains(rows, 1.0)
        self.assertEqual([row["gain"] for row in rows], ["1", "1", "0.05", "0.1", "2", "2.5"])
        text = "\n".join(self.sampling.conclude(rows, arguments))
        self.assertIn("25 times less error after 1 s than sampling uniform, nee off, expected 20: "
                      "pass", text)
        self.assertIn("2.5 times less error after 1 s than before: power, independent, expected 2: "
                      "pass", text)
        rows[3]["relmse"] = "0.1"
        self.assertIn("expected 20: MISS", "\n".join(self.sampling.conclude(rows, arguments)))

    def test_scene_files(self):
        with tempfile.TemporaryDirectory(prefix="ptexp scenes ") as folder:
            for name in ("b/scene.xml", "a/scene.xml", "a/note.txt"):
                Path(folder, name).parent.mkdir(exist_ok=True)
                Path(folder, name).touch()

            def found(scenes, quick=False):
                return [str(Path(path).relative_to(Path(folder).resolve())) for path in
                        self.sampling.scene_files(types.SimpleNamespace(scenes=scenes, quick=quick))]
            self.assertEqual(found([folder]), ["a/scene.xml", "b/scene.xml"])
            self.assertEqual(found([f"{folder}/b/scene.xml"]), ["b/scene.xml"])
            self.assertEqual(found([]), [])
            self.assertEqual(found(None, quick=True), [])
            with mock.patch.object(self.sampling, "SHARED", Path(folder, "none")), \
                    contextlib.redirect_stdout(io.StringIO()) as output:
                self.assertEqual(found(None), [])
            self.assertIn("no scene files", output.getvalue())

    def test_light_selection_is_left_to_scenes_that_have_it(self):
        ways = self.sampling.ways_of(PTEXP, "cornell")
        self.assertEqual(ways[self.sampling.BEFORE], "")
        self.assertNotIn("light-selection tree", ways)
        self.assertEqual(self.sampling.ways_of(PTEXP, "boxes"), self.sampling.WAYS)
        with self.assertRaises(harness.Refused):
            self.sampling.ways_of(PTEXP, "nowhere")


class SpeedTargets(unittest.TestCase):
    def test_verdicts(self):
        targets = importlib.import_module("speed_targets")

        def row(mode, spp, kernel_ms, waves=0):
            made = targets.configuration(mode, "spheres", 600, 300, spp, 50, False).labels
            return {**made, "mode": mode, "scene": "spheres", "width": "600", "height": "300",
                    "spp": str(spp), "max_depth": "50", "kernel_ms_median": str(kernel_ms),
                    "mpaths_per_s": "9000", "waves": str(waves), "used_pool_size": "1000",
                    "rays": "100000"}
        rows = [row("megakernel", 25, 0.6), row("megakernel", 50, 1.1), row("megakernel", 100, 2.5),
                row("wavefront", 50, 2.1, 160), row("wavefront", 100, 4.2, 161)]
        targets.finish(rows, type("Arguments", (), {"quick": False}))
        self.assertEqual([row["verdict"] for row in rows], ["", "pass", "", "MISS", ""])
        self.assertEqual([row["growth_verdict"] for row in rows], ["", "pass", "MISS", "", "pass"])
        self.assertEqual([row["waves_verdict"] for row in rows], ["", "", "", "pass", "MISS"])

    def test_rates_are_drawn_as_times(self):
        targets = importlib.import_module("speed_targets")
        self.assertEqual(targets.target_ms(">= 9 Gpaths/s", 288_000_000), "32")
        self.assertEqual(targets.target_ms("<= 1.2 ms", 9_000_000), "1.2")


if __name__ == "__main__":
    unittest.main()
