"""Runs `ptexp measure`: its answers are what a process for each configuration writes, errors leave it
running, memory does not grow, and it ends as it should.

The environment variable PTEXP names the executable (build/release/src/ptexp).
"""
import csv
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PTEXP = Path(os.environ.get("PTEXP", ROOT / "build" / "release" / "src" / "ptexp")).resolve()
TIMEOUT_S = 300  # generous, because the sanitizers share a busy machine

SMALL = "--device cpu --width 32 --height 24 --spp 4 --quiet --repeat 2 --warmup 1"
PLY = """ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 {z}
3 0 1 2
"""
# In an order in which scene, tree and renderer are kept, changed and kept again.
CONFIGURATIONS = """
    --scene cornell --mode serial
    --scene cornell --mode megakernel
    --scene cornell --mode megakernel --work pixel
    --scene cornell --mode wavefront
    --scene cornell --mode wavefront
    --scene cornell --mode wavefront --schedule host --pool-size 256 --threads 1
    --scene cornell --mode wavefront --accel brute --stages fused
    --scene cornell --mode wavefront --look-from 250,250,-700
    --scene cornell --integrator mlt --chains 64 --bootstrap 4096
    --scene spheres --spheres 20 --seed 7
    --scene spheres --spheres 30 --seed 7 --rng xorwow
    --scene spheres --spheres 30 --width 48
    --scene statue:1K --mode wavefront
    --scene statue:1K --mode megakernel --accel bvh2
    --scene statue:1K --mode megakernel --accel cwbvh
    --scene statue:1K --mode megakernel --accel cwbvh --builder sbvh
    --scene statue:1K --mode wavefront --compaction none --filter gaussian
    --scene statue:1K --mode wavefront --fov 30 --crop 3,4,20,20
    --scene triangle.ply --mode wavefront
    --scene triangle.ply --mode megakernel --look-from 1,1,3 --look-at 0,0,0
    --scene fog --mode wavefront --light-selection power
    --scene boxes --device cpu:2 --mode megakernel
    --scene statue:1K --mode wavefront --output b.exr --aov depth
    --scene statue:1K --mode wavefront --output c.png --exposure auto""".strip().splitlines()


def words_of(options):
    """A small picture; one thread, since more make another number of waves each time."""
    threads = [] if "--mode serial" in options else ["--threads", "1"]
    return [*shlex.split(SMALL), *threads, *shlex.split(options)]


def is_time(name):
    return name.endswith(("_ms", "_per_s")) or name in ("time_ms", "process_ms", "rates")


def without_times(value):
    """Without what times decide, either: into how many batches a render is divided, and which of
    several devices takes which pixels."""
    if isinstance(value, dict):
        by_times = ("launches", "waves", *(("units", "samples") if "units" in value else ()))
        return {name: without_times(one) for name, one in value.items()
                if not is_time(name) and name not in by_times}
    return [without_times(one) for one in value] if isinstance(value, list) else value


def row_without_times(row):
    return {name: text for name, text in row.items()
            if not re.search("_ms$|_ms_|_per_s$|_launches$|^launches$|^waves$|^devices$", name)}


def resident_kib(pid):
    return int(re.search(r"VmRSS:\s+(\d+)", Path(f"/proc/{pid}/status").read_text("ascii"))[1])


class Measure(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="ptexp measure ")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.write_scene(self.folder, 0)
        self.process = self.start()

    def write_scene(self, folder, z):
        (folder / "triangle.ply").write_text(PLY.format(z=z), encoding="utf-8")

    def start(self):
        # AddressSanitizer keeps freed memory, by default up to 256 MiB.
        options = os.environ.get("ASAN_OPTIONS", "") + ":quarantine_size_mb=1"
        process = subprocess.Popen(  # pylint: disable=consider-using-with
            [PTEXP, "measure"], cwd=self.folder, text=True, stdin=subprocess.PIPE,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            env={**os.environ, "ASAN_OPTIONS": options})

        def end():
            process.kill()
            process.communicate()
        self.addCleanup(end)
        return process

    def send(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()

    def ask(self, line):
        self.send(line)
        return json.loads(self.process.stdout.readline())

    def measure(self, options):
        return self.ask(json.dumps({"arguments": words_of(options)}))

    def measured(self, options):
        answer = self.measure(options)
        self.assertNotIn("error", answer, options)
        return answer

    def end(self, timeout_s=TIMEOUT_S):
        """(exit code, standard output, standard error)"""
        output, errors = self.process.communicate(timeout=timeout_s)
        return self.process.returncode, output, errors

    def single(self, options, folder):
        words = words_of(f"--stats run.json --csv row.csv {options}")
        subprocess.run([PTEXP, *words], cwd=folder, check=True, timeout=TIMEOUT_S,
                       stdin=subprocess.DEVNULL)
        with open(folder / "row.csv", newline="", encoding="utf-8") as file:
            row, = csv.DictReader(file)
        return json.loads((folder / "run.json").read_text(encoding="utf-8")), row

    def test_answers_are_those_of_single_processes(self):
        other = self.folder / "single"
        other.mkdir()
        self.write_scene(other, 0)
        for number, options in enumerate(CONFIGURATIONS):
            if "--output" not in options:
                options += " --output image.exr"
            with self.subTest(number=number, options=options.strip()):
                for place in (self.folder, other):
                    (place / "row.csv").unlink(missing_ok=True)
                answer = self.measured(f"--stats run.json --csv row.csv {options}")
                statistics, row = self.single(options, other)
                self.assertEqual(without_times(answer["statistics"]), without_times(statistics))
                self.assertEqual(list(answer["row"]), list(row))
                self.assertEqual(row_without_times(answer["row"]), row_without_times(row))
                with open(self.folder / "row.csv", newline="", encoding="utf-8") as file:
                    self.assertEqual(list(csv.DictReader(file)), [answer["row"]])
                self.assertEqual(json.loads((self.folder / "run.json").read_text("utf-8")),
                                 answer["statistics"])
                image = re.search(r"--output (\S+)", options)[1]
                compared = subprocess.run([PTEXP, "compare", self.folder / image, other / image],
                                          capture_output=True, text=True, check=False)
                self.assertEqual(compared.returncode, 0, compared.stdout + compared.stderr)

    def test_what_is_kept(self):
        def parts(options):
            statistics = self.measured(options)["statistics"]
            return statistics["process_ms"], statistics["scene"]["build_ms"]
        first, built = parts("--scene statue:1K --mode wavefront --accel cwbvh")
        self.assertEqual(first["start"], 0)
        self.assertAlmostEqual(sum(ms for name, ms in first.items() if name != "total"),
                               first["total"], delta=1e-6)
        self.assertTrue(first["scene"] > 0 and first["render"] > 0, first)
        second, same = parts("--scene statue:1K --mode megakernel --accel cwbvh --max-depth 3")
        self.assertEqual((second["scene"], same), (0, built))
        third, other = parts("--scene statue:1K --mode megakernel --accel bvh2")
        self.assertEqual(third["scene"], 0)
        self.assertNotEqual(other, built)
        self.assertGreater(parts("--scene statue:1200 --mode megakernel")[0]["scene"], 0)

    def test_a_changed_file_is_read_again(self):
        options = "--scene triangle.ply --mode wavefront"
        self.assertGreater(self.measured(options)["statistics"]["process_ms"]["scene"], 0)
        before = self.measured(f"{options} --output a.exr")["statistics"]
        self.assertEqual(before["process_ms"]["scene"], 0)
        self.write_scene(self.folder, 20)
        self.assertGreater(self.measured(options)["statistics"]["process_ms"]["scene"], 0)

    def test_errors_leave_it_running(self):
        before = self.measured("--scene cornell")["statistics"]["counts"]
        for line, words in (
                ("", "expected a line"), ("garbage", "expected a line"), ("[1]", "expected a line"),
                ("{}", "expected a line"), ('{"arguments": "--spp 1"}', "as strings"),
                ('{"arguments": ["--spp", 1]}', "as strings"),
                ('{"arguments": [], "more": 1}', "expected a line"),
                ('{"arguments": ["compare", "a", "b"]}', "no render"),
                ('{"arguments": ["measure"]}', "no render"), ('{"arguments": ["--help"]}', "no render"),
                ('{"arguments": ["--list-scenes"]}', "no render"),
                ('{"arguments": ["--checkpoint", "a.exr"]}', "--checkpoint"),
                ('{"arguments": ["--part", "1/2", "--checkpoint", "a.exr"]}', "--checkpoint"),
                ('{"arguments": ["--explain"]}', "--explain"),
                ('{"arguments": ["--bogus"]}', "--bogus"),
                ('{"arguments": ["--scene", "nowhere"]}', "nowhere"),
                ('{"arguments": ["--scene", "absent.ply"]}', "absent.ply"),
                ('{"arguments": ["--output", "absent/a.exr"]}', "absent/a.exr"),
                ('{"arguments": ["--scene", "triangle.ply", "--csv", "triangle.ply"]}', "triangle.ply"),
                ('{"arguments": ["--scene", "cornell", "--crop", "0,0,9999,1"]}', "crop")):
            answer = self.ask(line)
            self.assertEqual((list(answer), answer["exit_code"]), (["error", "exit_code"], 2), line)
            self.assertIn(words, answer["error"])
        self.assertEqual(self.measured("--scene cornell")["statistics"]["counts"], before)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["triangle.ply"])
        self.assertEqual(self.end(), (0, "", ""))

    def test_the_last_line_needs_no_end(self):
        self.process.stdin.write(json.dumps({"arguments": shlex.split(SMALL)}))
        code, output, _ = self.end()
        self.assertEqual((code, len(output.splitlines())), (0, 1))
        self.assertIn("statistics", json.loads(output))

    def test_memory_does_not_grow(self):
        sizes = []
        for number in range(50):
            scene = ("statue:100K", "terrain:100K", "spheres")[number // 2 % 3]
            mode = ("wavefront", "megakernel")[number % 2]
            self.measured(f"--scene {scene} --mode {mode} --repeat 1 --warmup 0")
            sizes.append(resident_kib(self.process.pid))
        self.assertLess(max(sizes[-12:]), 1.1 * max(sizes[:13]), sizes)

    def test_signals_end_it(self):
        self.measured("--scene cornell")
        self.process.send_signal(signal.SIGINT)  # while it waits for a line
        self.assertEqual(self.end()[0], 130)
        for number in (signal.SIGINT, signal.SIGTERM):
            self.process = self.start()
            self.measured("--scene cornell")
            self.send(json.dumps({"arguments": [*shlex.split(SMALL), "--spp", "100000000"]}))
            time.sleep(0.5)  # it renders by now
            self.process.send_signal(number)
            code, output, _ = self.end()
            self.assertEqual(code, 128 + number)
            if output:
                self.assertEqual(json.loads(output), {"error": "interrupted", "exit_code": 128 + number})

    def test_a_reader_that_has_gone_ends_it(self):
        self.process.stdout.close()
        self.send(json.dumps({"arguments": shlex.split(SMALL)}))
        self.assertEqual(self.process.wait(TIMEOUT_S), -signal.SIGPIPE)

    def test_it_is_one_process(self):
        if shutil.which("mpirun") is None or "MPI off" in subprocess.run(
                [PTEXP, "--version"], capture_output=True, text=True, check=True).stdout:
            self.skipTest("no MPI")
        run = subprocess.run(["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", "2", PTEXP,
                              "measure"], capture_output=True, text=True, check=False,
                             stdin=subprocess.DEVNULL, timeout=TIMEOUT_S)
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertIn("without a launcher", run.stderr)


if __name__ == "__main__":
    unittest.main()
