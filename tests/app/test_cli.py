"""Runs the real ptexp as a user does: options, images, exit codes, errors, interruption.

The environment variable PTEXP names the executable (build/release/src/ptexp).
"""
import csv
import json
import math
import os
import re
import resource
import signal
import struct
import subprocess
import tempfile
import time
import unittest
import zlib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PTEXP = Path(os.environ.get("PTEXP", ROOT / "build" / "release" / "src" / "ptexp")).resolve()
MODES = ["serial", "megakernel", "wavefront"]
TIMEOUT_S = 300  # of one run; generous, because the sanitizers share a busy machine

OPTIONS = """--mode --device --spp --width --height --max-depth --seed --scene --spheres --output
    --exposure --look-from --look-at --up --fov --aperture --focus-distance --threads --work --block
    --compaction --pool-size --layout --regenerate --schedule --scene-memory --branching --rng --repeat
    --warmup --stats --csv --quiet --list-scenes --list-devices --list-kernels --version --help""".split()


def read_ppm(path):
    """(width, height, 8-bit values) of a binary PPM."""
    header, data = re.match(rb"(P6\s+\d+\s+\d+\s+255\s)(.*)", Path(path).read_bytes(),
                            re.DOTALL).groups()
    width, height = map(int, header.split()[1:3])
    if len(data) != 3 * width * height:
        raise ValueError(f"{path}: {len(data)} bytes for {width}x{height} pixels")
    return width, height, data


def read_png(path):
    """(width, height, unfiltered size) of an 8-bit RGB PNG, with its checksums verified."""
    data = Path(path).read_bytes()
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise ValueError(f"{path} is no PNG")
    at, header, pixels, kind = 8, None, b"", None
    while kind != b"IEND":
        length, kind = struct.unpack_from(">I4s", data, at)
        body = data[at + 8:at + 8 + length]
        if zlib.crc32(kind + body) != struct.unpack_from(">I", data, at + 8 + length)[0]:
            raise ValueError(f"{path}: checksum of {kind}")
        header = struct.unpack(">IIBB3x", body) if kind == b"IHDR" else header
        pixels += body if kind == b"IDAT" else b""
        at += 12 + length
    if header[2:] != (8, 2):
        raise ValueError(f"{path}: bit depth and colour type {header[2:]}")
    return header[0], header[1], len(zlib.decompress(pixels))


def available_memory_gib():
    text = Path("/proc/meminfo").read_text(encoding="ascii")
    return int(re.search(r"MemAvailable:\s*(\d+) kB", text).group(1)) / 2**20


def processor_time_s(pid):
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class CommandLine(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="ptexp cli ")  # a space, as users have
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_ptexp(self, *arguments, **popen):
        return subprocess.run([PTEXP, *map(str, arguments)], cwd=self.folder, capture_output=True,
                              stdin=subprocess.DEVNULL, text=True, check=False, timeout=TIMEOUT_S,
                              **popen)

    def run_ok(self, *arguments):
        run = self.run_ptexp(*arguments)
        self.assertEqual(run.returncode, 0, f"{arguments}\n{run.stdout}{run.stderr}")
        return run

    def render(self, *arguments, **popen):
        """A small picture on the CPU; later arguments win over these."""
        small = {"--device": "cpu", "--width": "24", "--height": "12", "--spp": "4"}
        for name in arguments:
            small.pop(name, None)
        return self.run_ptexp(*[part for pair in small.items() for part in pair], *arguments,
                              **popen)

    def render_ok(self, *arguments):
        run = self.render(*arguments)
        self.assertEqual(run.returncode, 0, f"{arguments}\n{run.stdout}{run.stderr}")
        return run

    def files(self):
        return sorted(path.name for path in self.folder.iterdir())

    def assert_refused(self, run, *words):
        """Exit code 2, and one line on stderr that contains `words`."""
        shown = f"{run.args[1:]}\n{run.stdout}{run.stderr}"
        self.assertEqual(run.returncode, 2, shown)
        self.assertEqual(len(run.stderr.splitlines()), 1, shown)
        for word in words:
            self.assertIn(str(word).lower(), run.stderr.lower(), shown)


class Information(CommandLine):
    def test_help_names_every_option(self):
        run = self.run_ok("--help-all")
        self.assertEqual(run.stderr, "")
        for option in OPTIONS:
            self.assertRegex(run.stdout, rf"(?m)(^|[\s,]){option}\b")
        self.assertIn("compare", run.stdout)
        self.assertEqual(self.run_ok("compare", "--help").stderr, "")

    def test_version_tells_commit_and_build(self):
        text = self.run_ok("--version").stdout
        self.assertRegex(text, r"ptexp \d+\.\d+\.\d+")
        self.assertRegex(text, r"(?i)commit\s*:?\s*\S+|[0-9a-f]{7,}|unknown")
        self.assertRegex(text, r"(?i)cuda")
        # By their values, which the statistics have, too; doctor knows the MPI that is loaded.
        self.render_ok("--output", "a.ppm", "--stats", "s.json")
        program = json.loads((self.folder / "s.json").read_text(encoding="utf-8"))["program"]
        math_text = ", fast math" if program["fast_math"] else ""
        self.assertTrue(text.startswith(
            f"ptexp {program['version']}\ncommit {program['commit']}\nbuild {program['build_type']}, "
            f"{program['compiler']}\nCUDA {program['cuda']}{math_text}\nMPI "), text)

    def test_a_device_is_listed_as_it_is_called(self):
        line = next(line for line in self.run_ok("--list-devices").stdout.splitlines() if line.startswith("cpu"))
        run = self.render_ok("--output", "a.ppm", "--stats", "s.json")
        name, detail = re.fullmatch(r"cpu +(.*) \((.*)\)", line).groups()
        self.assertTrue(run.stdout.startswith(f"device cpu: {name} ({detail})\n"), run.stdout)
        device = json.loads((self.folder / "s.json").read_text(encoding="utf-8"))["device"]
        self.assertEqual(device["name"], f"{name}, {detail}")

    def test_scenes_are_listed_and_can_be_rendered(self):
        text = self.run_ok("--list-scenes").stdout
        for scene in ["spheres", "rtow", "cornell", "furnace", "ajar", "caustic"]:
            self.assertRegex(text, rf"(?m)^\s*{scene}\b")
            self.render_ok("--scene", scene, "--output", f"{scene}.ppm")
            self.assertEqual(read_ppm(self.folder / f"{scene}.ppm")[:2], (24, 12))

    def test_devices_are_listed(self):
        self.assertRegex(self.run_ok("--list-devices").stdout, r"(?m)^\s*cpu\b")

    def test_information_writes_no_file(self):
        for option in ["--help", "--version", "--list-scenes", "--list-devices", "--list-kernels"]:
            self.run_ok(option)
        self.assertEqual(self.files(), [])


class Images(CommandLine):
    def test_the_papers_command_writes_an_image(self):
        run = self.run_ok("--mode", "wavefront", "--spp", "50", "--device", "cpu", "--width", "60",
                          "--height", "30")
        self.assertEqual(self.files(), ["image.exr"])
        self.assertRegex(run.stdout, r"(?i)paths")
        self.assertNotRegex(run.stdout + run.stderr, "[\r\x1b]", "piped output is plain lines")

    def test_the_automatic_device_is_named(self):
        run = self.run_ok("--device", "auto", "--width", "24", "--height", "12", "--spp", "4")
        self.assertRegex(run.stdout + run.stderr, r"CPU|NVIDIA|Tesla|GeForce")

    def test_the_ending_chooses_the_format(self):
        for ending in ["ppm", "png", "exr"]:
            self.render_ok("--output", f"image.{ending}")
        self.assertEqual(self.files(), ["image.exr", "image.png", "image.ppm"])
        width, height, values = read_ppm(self.folder / "image.ppm")
        self.assertEqual((width, height), (24, 12))
        self.assertGreater(len(set(values)), 20, "a picture has more than a few shades")
        self.assertEqual(read_png(self.folder / "image.png"), (24, 12, 12 * (1 + 3 * 24)))
        self.assertEqual((self.folder / "image.exr").read_bytes()[:4], b"\x76\x2f\x31\x01")

    def test_an_image_goes_to_another_folder(self):
        (self.folder / "a b").mkdir()
        self.render_ok("--output", self.folder / "a b" / "c.d.png")
        self.assertEqual(read_png(self.folder / "a b" / "c.d.png")[:2], (24, 12))

    def test_an_image_is_replaced(self):
        (self.folder / "image.ppm").write_bytes(b"old")
        self.render_ok("--output", "image.ppm")
        self.assertEqual(read_ppm(self.folder / "image.ppm")[:2], (24, 12))
        self.assertEqual(self.files(), ["image.ppm"])

    def test_the_smallest_image(self):
        for mode in MODES:
            self.render_ok("--mode", mode, "--width", "1", "--height", "1", "--spp", "1",
                           "--max-depth", "1", "--spheres", "0", "--output", f"{mode}.ppm")
            self.assertEqual(read_ppm(self.folder / f"{mode}.ppm")[:2], (1, 1))

    def test_exposure_brightens(self):
        means = []
        for stops in ["-2", "0", "2"]:
            self.render_ok("--exposure", stops, "--output", "image.ppm")
            values = read_ppm(self.folder / "image.ppm")[2]
            means.append(sum(values) / len(values))
        self.assertEqual(means, sorted(set(means)))

    def test_no_more_threads_run_than_there_are_processors(self):
        def use_one():
            os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})

        run = self.render("--threads", "64", "--quiet", "--stats", "run.json", "--csv", "runs.csv",
                          preexec_fn=use_one)
        self.assertEqual((run.returncode, run.stdout + run.stderr), (0, ""))
        stats = json.loads((self.folder / "run.json").read_text(encoding="utf-8"))
        self.assertEqual(stats["device"]["name"], "CPU, 1 thread")
        with open(self.folder / "runs.csv", newline="", encoding="utf-8") as file:
            self.assertEqual(next(csv.DictReader(file))["device_name"], "CPU, 1 thread")

    def test_quiet_says_nothing(self):
        run = self.render_ok("--quiet", "--output", "image.ppm")
        self.assertEqual(run.stdout + run.stderr, "")


class SceneFile(CommandLine):
    # Above the camera, nearer than the near plane, in sight in a tall image alone.
    SCENE = """<scene version="3.0.0">
      <sensor type="perspective"><float name="fov" value="40"/><string name="fov_axis" value="x"/>
        <float name="near_clip" value="2.5"/>
        <transform name="to_world"><lookat origin="0, 0, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="20"/><integer name="height" value="60"/></film>
      </sensor>
      <shape type="sphere"><float name="radius" value="0.2"/><point name="center" x="0" y="2.2" z="2.9"/></shape>
      <shape type="cube"><transform name="to_world"><scale value="0.5"/></transform></shape>
      <emitter type="constant"/></scene>"""

    def test_its_image_has_the_size_for_which_it_is_prepared(self):
        (self.folder / "tall.xml").write_text(self.SCENE)
        scene = ["--scene", "tall.xml", "--device", "cpu", "--spp", 4, "--quiet"]
        self.run_ok(*scene, "--output", "file.exr")
        self.run_ok(*scene, "--width", 20, "--height", 60, "--output", "given.exr")
        self.run_ok("compare", "file.exr", "given.exr")


class Compare(CommandLine):
    def compare(self, *arguments):
        return self.run_ptexp("compare", *arguments)

    def test_all_modes_give_the_same_image(self):
        for scene in ["spheres", "cornell"]:
            for mode in MODES:
                self.render_ok("--mode", mode, "--scene", scene, "--output", f"{mode}.exr")
            for mode in MODES[1:]:
                run = self.compare("serial.exr", f"{mode}.exr")
                self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
                self.assertRegex(run.stdout, r"(?im)^differing pixels\D*0$")

    def test_threads_and_queues_do_not_change_the_image(self):
        self.render_ok("--output", "a.exr")
        for i, options in enumerate([["--threads", 1], ["--threads", 3], ["--pool-size", 7],
                                     ["--compaction", "none"], ["--regenerate", "off"],
                                     ["--branching", "reduced"]]):
            self.render_ok(*options, "--output", f"{i}.exr")
            self.assertEqual(self.compare("a.exr", f"{i}.exr").returncode, 0, options)

    def test_differing_images(self):
        self.render_ok("--seed", "1", "--output", "a.exr")
        self.render_ok("--seed", "2", "--output", "b.exr")
        run = self.compare("a.exr", "b.exr")
        self.assertEqual(run.returncode, 1, run.stdout + run.stderr)
        for word in ["RMSE", "relMSE", "largest", "differing"]:
            self.assertIn(word, run.stdout)
        rmse = float(re.search(r"(?m)^RMSE\s+(\S+)$", run.stdout).group(1))
        self.assertTrue(0 < rmse < math.inf)
        self.assertEqual(self.compare("a.exr", "b.exr", "--tolerance", "1000").returncode, 0)
        self.assertEqual(self.compare("a.exr", "b.exr", "--tolerance", "1e-9").returncode, 1)

    def test_formats_can_be_compared(self):
        for ending in ["png", "ppm"]:
            self.render_ok("--output", f"a.{ending}")
            self.assertEqual(self.compare(f"a.{ending}", f"a.{ending}").returncode, 0)

    def test_bad_input(self):
        self.render_ok("--output", "a.ppm")
        self.render_ok("--width", "25", "--output", "wide.ppm")
        (self.folder / "text.exr").write_text("no image", encoding="ascii")
        (self.folder / "empty.png").write_bytes(b"")
        whole = (self.folder / "a.ppm").read_bytes()
        (self.folder / "short.ppm").write_bytes(whole[:-1])
        before = self.files()
        self.assert_refused(self.compare("a.ppm", "missing.ppm"), "missing.ppm")
        self.assert_refused(self.compare("a.ppm", "wide.ppm"), "24x12", "25x12")
        self.assert_refused(self.compare("a.ppm", "text.exr"), "text.exr")
        self.assert_refused(self.compare("empty.png", "a.ppm"), "empty.png")
        self.assert_refused(self.compare("a.ppm", "short.ppm"), "short.ppm")
        self.assert_refused(self.compare("a.ppm"))
        self.assert_refused(self.compare("a.ppm", "a.ppm", "a.ppm"))
        self.assert_refused(self.compare("a.ppm", "a.ppm", "--tolerance", "-1"), "tolerance")
        self.assert_refused(self.compare("a.ppm", "a.ppm", "--tolerance", "nan"), "tolerance")
        self.assertEqual(self.files(), before)


class Statistics(CommandLine):
    def test_csv_has_one_header(self):
        for mode in MODES:
            self.render_ok("--mode", mode, "--csv", "runs.csv")
        with open(self.folder / "runs.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file, strict=True))
        self.assertEqual(len(rows), 1 + len(MODES))
        self.assertEqual({len(row) for row in rows}, {len(rows[0])})
        self.assertEqual(len(set(rows[0])), len(rows[0]), "column names are unique")
        self.assertTrue(any("schema" in name for name in rows[0]), rows[0])
        self.assertEqual([row[rows[0].index("mode")] for row in rows[1:]], MODES)

    def test_a_foreign_csv_is_left_alone(self):
        (self.folder / "runs.csv").write_text("a,b\n1,2\n", encoding="ascii")
        self.assert_refused(self.render("--csv", "runs.csv", "--output", "image.ppm"), "runs.csv")
        self.assertEqual((self.folder / "runs.csv").read_text(encoding="ascii"), "a,b\n1,2\n")

    def test_the_wall_time_of_the_process_is_divided(self):
        begin = time.monotonic()
        self.render_ok("--scene", "boxes", "--spp", "16", "--stats", "run.json", "--csv", "runs.csv")
        wall_ms = 1e3 * (time.monotonic() - begin)
        times = json.loads((self.folder / "run.json").read_text(encoding="utf-8"))["process_ms"]
        total = times.pop("total")
        self.assertAlmostEqual(total, sum(times.values()), delta=1e-3)
        self.assertGreaterEqual(min(times.values()), 0)
        clock_ms = 10  # of the process's begin
        self.assertLess(total, wall_ms + 2 * clock_ms)
        self.assertGreater(times["render"], 0.3 * total)
        with open(self.folder / "runs.csv", newline="", encoding="utf-8") as file:
            row = next(csv.DictReader(file))
        self.assertAlmostEqual(float(row["process_total_ms"]), total, delta=1e-3)

    def test_json_is_complete(self):
        self.render_ok("--stats", "run.json", "--repeat", "3", "--warmup", "1")
        text = (self.folder / "run.json").read_text(encoding="utf-8")
        self.assertIsInstance(json.loads(text), dict)
        for word in ["schema", "wavefront", "Philox|philox", "rays", "median", "generate"]:
            self.assertRegex(text, word)

    def test_the_plan_is_explained_and_recorded(self):
        before = self.files()
        for mode, options in (("serial", {"accel"}), ("megakernel", {"accel"}),
                              ("wavefront", {"accel", "stages", "finish-paths", "pool-size"})):
            text = self.render_ok("--mode", mode, "--scene", "boxes", "--explain").stdout
            said = dict(re.findall(r"(?m)^--(\S+) +(\S.*?)  +\S", text))
            self.assertLessEqual(options | {"kernel-set"}, set(said), text)
            self.assertEqual(said["kernel-set"], "general", text)
            self.assertEqual(self.files(), before)
            self.render_ok("--mode", mode, "--scene", "boxes", "--stats", f"{mode}.json")
            run = json.loads((self.folder / f"{mode}.json").read_text(encoding="utf-8"))
            self.assertEqual({d["option"]: d["value"] for d in run["plan"]}, said)
            self.assertEqual(run["used"]["accel"], said["accel"])
            self.assertEqual((run["used"]["mode"], said["mode"]), (mode, mode))
            before = self.files()

    def test_the_plan_is_explained_before_anything_is_built(self):
        explained = self.run_ptexp("--scene", "terrain:100K", "--device", "cpu", "--explain")
        self.assertEqual(explained.returncode, 0, explained.stderr)
        self.assertNotIn("\nscene: ", explained.stdout)  # a render says what it has built
        # What a render refuses is refused here, too.
        for options in ("--rng xorwow --aov albedo", "--integrator mlt --aov albedo",
                        "--scene spheres --builder sah"):
            texts = [self.run_ptexp("--device", "cpu", *options.split(), *more).stderr
                     for more in ((), ("--explain",))]
            self.assertEqual(*texts)
            self.assertIn("error: --", texts[0])

    def test_samples_that_are_asked_for_limit_a_stop(self):
        for stop in ("--target-error 0.5", "--time-limit 20"):
            self.render_ok("--stats", "run.json", "--spp", "6", *stop.split())
            run = json.loads((self.folder / "run.json").read_text(encoding="utf-8"))
            self.assertEqual((run["samples_done"], run["ended_by"], run["complete"]),
                             (6, "samples", True), stop)
        # Where they are not asked for, the stop decides: the default of samples would be enough.
        run = self.run_ptexp("--width", "8", "--height", "4", "--time-limit", "0.4", "--stats",
                             "run.json", "--output", "image.ppm", "--device", "cpu")
        self.assertEqual(run.returncode, 0, run.stderr)
        run = json.loads((self.folder / "run.json").read_text(encoding="utf-8"))
        self.assertEqual((run["ended_by"], run["complete"]), ("time_limit", True))
        self.assertGreater(run["samples_done"], 50)

    def test_modes_trace_the_same_rays(self):
        counts = set()
        for mode in MODES:
            self.render_ok("--mode", mode, "--csv", "runs.csv")
        with open(self.folder / "runs.csv", newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                counts.add((row["paths"], row["rays"]))
        self.assertEqual(len(counts), 1, counts)
        self.assertEqual(int(counts.pop()[0]), 24 * 12 * 4)


class Advise(CommandLine):
    SMALL = ("--device", "cpu", "--threads", "1", "--width", "16", "--height", "8", "--spp", "2",
             "--max-depth", "3")

    def test_advice_can_be_followed(self):
        run = self.run_ok("advise", "spheres", "--spheres", "20", *self.SMALL)
        lines = run.stdout.splitlines()
        self.assertLessEqual(len(lines), 10, run.stdout)
        found = re.match(r"spheres, CPU, 1 thread: use (the default|--.*?)[;,] ", lines[0])
        self.assertTrue(found, run.stdout)
        self.render_ok("--scene", "spheres", *found[1].removeprefix("the default").split())
        self.assertIn("--mode megakernel", run.stdout)
        self.assertIn("Why auto chose wavefront: ", run.stdout)
        self.assertRegex(run.stderr, "trying --mode megakernel\n")
        self.assertEqual(self.files(), ["image.exr"])  # of the render; advice writes none

    def test_quiet_has_the_advice_alone(self):
        run = self.run_ok("advise", "spheres", *self.SMALL, "--mode", "megakernel", "--quiet")
        self.assertEqual(run.stderr, "")
        self.assertNotIn("wavefront", run.stdout)

    def test_what_it_refuses(self):
        for arguments, words in (((), "expected SCENE"), (("spheres", "--output", "a.exr"), "--output"),
                                 (("spheres", "--target-error", "0.1"), "--target-error"),
                                 (("spheres", "--time-limit", "0"), "--time-limit 0"),
                                 (("spheres", "-q", "--time-limit", "1e-9"), "no render ended before"),
                                 (("nowhere",), "no such scene"), (("absent.xml",), "absent.xml"),
                                 (("spheres", "--device", "cpu", "--kernel", "loop"), "--kernel")):
            self.assert_refused(self.run_ptexp("advise", *arguments), words)
        self.assertEqual(self.files(), [])


class Calibrate(CommandLine):
    RENDER = ("--scene", "spheres", "--threads", "2")

    def with_cache(self, *arguments):
        return self.run_ptexp(*arguments, env={**os.environ, "XDG_CACHE_HOME": str(self.folder / "cache")})

    def explained(self, *arguments):
        run = self.with_cache(*self.RENDER, "--device", "cpu", "--explain", *arguments)
        self.assertEqual(run.returncode, 0, run.stderr)
        return run

    def test_later_runs_use_what_it_measures(self):
        self.assertNotIn("measured here", self.explained().stdout)
        begin_s = time.monotonic()
        run = self.with_cache("calibrate", "--device", "cpu", "--threads", "2")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertLess(time.monotonic() - begin_s, 32)  # the last render may end late
        self.assertIn("measuring: scan against tree\n", run.stderr)
        file = Path(run.stdout.rpartition("wrote ")[2].strip())
        self.assertEqual(file.parent, self.folder / "cache" / "ptexp")
        self.assertRegex(file.name, r"calibration-.*-2-threads-ptexp-[\d.]+\.json")
        found = json.loads(file.read_text(encoding="utf-8"))
        self.assertGreater(len(found["constants"]) + len(found["kept"]), 5)
        # On a busy machine times may tell nothing: what is planted there counts as well.
        found["constants"]["scan_primitives"] = 20
        file.write_text(json.dumps(found), encoding="utf-8")
        text = self.explained().stdout
        self.assertIn("up to 20 are scanned faster than a tree is walked (measured here)", text)
        self.assertIn("(from an H200)", self.explained("--calibration", "none").stdout)
        self.assertNotIn("measured here", self.explained("--threads", "1").stdout)
        used = []
        for choice in ("auto", "none", file):
            run = self.with_cache(*self.RENDER, "--device", "cpu", "--width", "8", "--height", "8",
                                  "--spp", "1", "--calibration", choice, "--output", "a.ppm",
                                  "--quiet", "--stats", "s.json", "--csv", "s.csv")
            self.assertEqual((run.returncode, run.stderr), (0, ""))
            used.append(json.loads((self.folder / "s.json").read_text("utf-8"))["used"]["calibration"])
        with open(self.folder / "s.csv", newline="", encoding="utf-8") as rows:
            self.assertEqual([row["used_calibration"] for row in csv.DictReader(rows)], used)
        self.assertRegex(used[0], "^[0-9a-f]{16}$")
        self.assertEqual(used, [used[0], "", used[0]])

        file.write_text("{", encoding="utf-8")
        run = self.explained()
        self.assertNotIn("measured here", run.stdout)
        self.assertEqual(len(run.stderr.splitlines()), 1, run.stderr)
        self.assertIn(f"{file}: expected an object of JSON; ignored", run.stderr)
        self.assert_refused(self.with_cache(*self.RENDER, "--device", "cpu", "--calibration", file,
                                            "--output", "b.ppm"), file)

    def test_what_it_refuses(self):
        for arguments, words in ((("--spp", "2"), "--spp"), (("cornell",), "cornell"),
                                 (("--device", "cpu:2"), "one device"), (("--threads", "x"), "--threads x"),
                                 (("--device", "cuda:77"), "--device cuda:77")):
            self.assert_refused(self.with_cache("calibrate", *arguments), words)
        self.assert_refused(self.run_ptexp("calibrate", "--device", "cpu", "--quiet", env={}),
                            "no cache folder")
        self.assertEqual(self.files(), [])


class BadInput(CommandLine):
    """Everything here is refused before any work, with one line and without a trace."""

    def assert_bad(self, *arguments, words=()):
        with self.subTest(arguments=arguments):
            before = self.files()
            self.assert_refused(self.render(*arguments), *words)
            self.assertEqual(self.files(), before)

    def test_unknown_names(self):
        self.assert_bad("--frobnicate", words=["--frobnicate"])
        self.assert_bad("--frobnicate", "3", words=["frobnicate"])
        self.assert_bad("stray.exr", words=["stray.exr"])
        for option in ["--mode", "--scene", "--device", "--work", "--compaction", "--schedule",
                       "--regenerate", "--scene-memory", "--branching", "--rng"]:
            self.assert_bad(option, "nonsense", words=[option, "nonsense"])
            self.assert_bad(option, "", words=[option])

    def test_a_missing_value(self):
        self.assert_bad("--spp")
        self.assert_bad("--mode")

    def test_a_missing_gpu(self):
        self.assert_bad("--device", "cuda:99", words=["cuda"])
        self.assert_bad("--device", "cuda:-1", words=["cuda"])

    def test_sizes(self):
        for option in ["--width", "--height", "--spp", "--max-depth", "--repeat"]:
            for value in ["0", "-1", "99999999999999999999", "ten", "1.5", "1e3x", " 4", ""]:
                self.assert_bad(option, value, words=[option])
        for option in ["--width", "--height", "--max-depth"]:
            self.assert_bad(option, "65536", words=[option, "65,535"])
        for option in ["--spheres", "--threads", "--warmup", "--seed"]:
            self.assert_bad(option, "-1", words=[option])
        for value in ["0", "-1", "x", "99999999999999999999"]:
            self.assert_bad("--pool-size", value, words=["--pool-size"])

    def test_camera(self):
        for option, values in {"--fov": ["0", "180", "-10", "nan", "x"],
                               "--aperture": ["-1", "nan", "inf"],
                               "--focus-distance": ["0", "-1", "nan", "inf"],
                               "--exposure": ["nan", "inf", "x"],
                               "--look-from": ["1,2", "1,2,3,4", "nan,0,0", "x"]}.items():
            for value in values:
                self.assert_bad(option, value, words=[option])
        self.assert_bad("--look-from", "1,1,1", "--look-at", "1,1,1", words=["look"])
        self.assert_bad("--look-from", "0,0,0", "--look-at", "0,1,0", "--up", "0,2,0",
                        words=["up"])

    def test_blocks(self):
        for mode in MODES:
            self.assert_bad("--mode", mode, "--block", "64x64", words=["64x64", "1,024"])
        self.assert_bad("--block", "33x32", words=["1,024"])
        for value in ["0x4", "4x0", "4", "4x", "x4", "4x4x4", "-4x4", "4X4", "9999999999x1"]:
            self.assert_bad("--block", value, words=["--block"])

    def test_outputs(self):
        (self.folder / "folder.png").mkdir()
        self.assert_bad("--output", "missing/image.exr", words=["missing/image.exr"])
        self.assert_bad("--output", "folder.png", words=["folder.png"])
        self.assert_bad("--output", "image.jpg", words=["image.jpg", ".exr", ".png", ".ppm"])
        self.assert_bad("--output", "image", words=["image"])
        self.assert_bad("--output", "")
        self.assert_bad("--csv", "missing/runs.csv", words=["missing/runs.csv"])
        self.assert_bad("--stats", "missing/run.json", words=["missing/run.json"])

    @unittest.skipIf(os.geteuid() == 0, "root may write everywhere")
    def test_a_folder_without_permission(self):
        (self.folder / "closed").mkdir(mode=0o500)
        self.assert_bad("--output", "closed/image.exr", words=["closed/image.exr"])

    def test_an_existing_image_survives_a_failed_run(self):
        (self.folder / "image.png").write_bytes(b"precious")
        self.assert_bad("--output", "image.png", "--block", "64x64")
        self.assert_bad("--output", "image.png", "--csv", "missing/runs.csv")
        self.assertEqual((self.folder / "image.png").read_bytes(), b"precious")

    def test_a_full_disk(self):
        def limit_file_size():
            resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))

        for name in ["image.ppm", "image.png", "image.exr"]:
            (self.folder / name).write_bytes(b"precious")
        for name in self.files():
            with self.subTest(name=name):
                # Python ignores SIGXFSZ and restore_signals=False hands that on, so that a write
                # fails as it does on a full disk.
                run = self.render("--output", name, preexec_fn=limit_file_size,
                                  restore_signals=False)
                self.assert_refused(run, name)
                self.assertEqual(self.files(), ["image.exr", "image.png", "image.ppm"])
                self.assertEqual((self.folder / name).read_bytes(), b"precious")

    @unittest.skipIf(available_memory_gib() > 40, "this machine could hold the image")
    def test_too_much_memory(self):
        for mode in MODES:
            with self.subTest(mode=mode):
                run = self.render("--mode", mode, "--width", "65535", "--height", "65535")
                self.assert_refused(run, "memory")
                self.assertRegex(run.stderr, r"\d[\d.,]* ?[MGT]i?B", "says how much is needed")
                self.assertEqual(self.files(), [])


    def test_too_many_primitives(self):
        def limit_memory():
            resource.setrlimit(resource.RLIMIT_AS, (4_000_000_000, 4_000_000_000))

        if self.run_ptexp("--version", preexec_fn=limit_memory).returncode != 0:
            self.skipTest("this build needs more memory to begin with (a sanitizer's shadow)")
        for scene in [["terrain:50M"], ["statue:50M"], ["instances:50M"],
                      ["spheres", "--spheres", "50000000"]]:
            with self.subTest(scene=scene):
                begin = time.monotonic()
                run = self.render("--quiet", "--scene", *scene, preexec_fn=limit_memory)
                self.assert_refused(run, " ".join(scene[-2:]))
                self.assertRegex(run.stderr, r"needs [\d,]+ MiB, [\d,]+ MiB are free")
                self.assertLess(time.monotonic() - begin, 5, "before anything is made")
        self.assertEqual(self.files(), [])

    def test_rays_without_room(self):
        def limit_file_size():
            resource.setrlimit(resource.RLIMIT_FSIZE, (10_000_000, 10_000_000))

        run = self.run_ptexp("rays", "--scene", "terrain:4M", "--kind", "ao", "--size", "256",
                             "--output", "rays", preexec_fn=limit_file_size)
        self.assert_refused(run, "rays", "17 MB are needed, 10 MB are free")
        self.assertEqual(self.files(), [])


class StandardOutput(CommandLine):
    """What is printed is a result like any other: it is there, or the exit code tells."""

    def setUp(self):
        super().setUp()
        if not Path("/dev/full").exists():
            self.skipTest("the machine has no /dev/full")

    def run_into_full(self, *arguments):
        with open("/dev/full", "w", encoding="ascii") as full:
            return subprocess.run([PTEXP, *arguments], cwd=self.folder, stdout=full,
                                  stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True,
                                  check=False, timeout=TIMEOUT_S)

    def test_of_every_command(self):
        self.render_ok("--output", "a.ppm")
        self.run_ok("rays", "--scene", "boxes", "--size", "16", "--output", "r")
        before = self.files()
        for arguments in [["--help"], ["--help-all"], ["--version"], ["--list-scenes"], ["--list-devices"], ["--list-kernels"],
                          ["compare", "--help"], ["compare", "a.ppm", "a.ppm"],
                          ["trace", "--mesh", "boxes", "--rays", "r", "--device", "cpu"],
                          ["compact", "--device", "cpu", "--items", "1K", "--repeat", "1"],
                          ["--device", "cpu", "--spp", "1"]]:
            with self.subTest(arguments=arguments):
                run = self.run_into_full(*arguments)
                self.assertEqual(run.returncode, 2, run.stderr)
                self.assertRegex(run.stderr, r"^ptexp: error: .*No space left on device\n$")
                self.assertEqual(self.files(), before, "refused before the image is rendered")

    def test_silence_needs_none(self):
        run = self.run_into_full("--device", "cpu", "--spp", "1", "--quiet")
        self.assertEqual((run.returncode, run.stderr), (0, ""))

    def test_rays_are_announced(self):
        run = self.run_ok("rays", "--scene", "boxes", "--kind", "ao", "--size", "256", "--output",
                          "r")
        self.assertRegex(run.stderr, r"^ptexp: rays: up to 17 MB will be written to r\n$")
        self.assertLessEqual((self.folder / "r").stat().st_size, 17_000_000)


class Streams(CommandLine):
    """Full, closed and hostile streams: messages are lost, images are not."""

    ODD = ('<scene version="3.0.0"><sensor type="perspective"/><shape type="sphere"/>'
           "<shape type='hair\x9b\u202ex'/></scene>")

    def run_streams(self, *arguments, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, **popen):
        return subprocess.run([PTEXP, *arguments], cwd=self.folder, stdin=subprocess.DEVNULL,
                              stdout=stdout, stderr=stderr, check=False, timeout=TIMEOUT_S,
                              **popen).returncode

    def setUp(self):
        super().setUp()
        (self.folder / "odd.xml").write_text(self.ODD, encoding="utf-8")
        self.scene = ["--scene", "odd.xml", "--device", "cpu", "--width", "24", "--height", "12",
                      "--spp", "2", "-o", "a.exr"]
        self.assertEqual(self.run_streams(*self.scene), 0)
        (self.folder / "a.exr").rename(self.folder / "right.exr")

    def assert_image(self, name="a.exr"):
        self.assertRegex(self.run_ok("compare", name, "right.exr").stdout, "differing pixels +0\n")
        (self.folder / name).unlink()
        self.assertEqual(self.files(), ["odd.xml", "right.exr"])

    def test_a_full_stderr(self):
        if not Path("/dev/full").exists():
            self.skipTest("the machine has no /dev/full")
        with open("/dev/full", "wb") as full:
            self.assertEqual(self.run_streams(*self.scene, stderr=full), 0)
            self.assert_image()
            for wrong in (["--scene", "none.xml"], ["--spp", "x"], ["merge", "a.exr", "none.exr"]):
                self.assertEqual(self.run_streams(*wrong, stderr=full), 2)

    def test_closed_streams_are_no_files(self):
        """A file that took the place of stderr would get the warnings."""
        for closed in ((2,), (0, 2), (0, 1, 2)):
            def close(streams=closed):
                for stream in streams:
                    os.close(stream)

            quiet = ["-q"] if 1 in closed else []
            with self.subTest(closed=closed):
                self.assertEqual(self.run_streams(*self.scene, *quiet, preexec_fn=close), 0)
                self.assert_image()
        self.assertEqual(self.run_streams(*self.scene, preexec_fn=lambda: os.close(1)), 2)
        self.assertEqual(self.run_streams("--scene", "none.xml", preexec_fn=lambda: os.close(2)), 2)
        os.symlink("/dev/stdout", self.folder / "out.ppm")
        self.assertEqual(self.run_streams(*self.scene, "-q", "-o", "out.ppm",
                                          preexec_fn=lambda: os.close(1)), 2)

    def test_readers_that_have_gone(self):
        for stream in ("stdout", "stderr"):
            reader, writer = os.pipe()
            os.close(reader)
            quiet = ["-q"] if stream == "stdout" else []
            code = self.run_streams(*self.scene, *quiet, **{stream: writer})
            os.close(writer)
            self.assertEqual(code, 0)
            self.assert_image()
        # A closed pipe ends what is printed, as in other programs.
        reader, writer = os.pipe()
        os.close(reader)
        self.assertEqual(self.run_streams("--help", stdout=writer), -signal.SIGPIPE)
        os.close(writer)

    def test_a_reader_that_goes_early(self):
        """As `ptexp ... | head -1`: the image is there all the same."""
        process = subprocess.Popen([PTEXP, *self.scene, "--spp", "2", "--repeat", "100",
                                    "--warmup", "1"], cwd=self.folder, stdout=subprocess.PIPE,
                                   stderr=subprocess.DEVNULL)
        process.stdout.readline()
        process.stdout.close()
        self.assertEqual(process.wait(TIMEOUT_S), -signal.SIGPIPE)
        self.assert_image()

    def test_a_limit_of_sizes_kills_nothing(self):
        for name in ("a.exr", "a.png", "a.ppm"):
            run = self.run_ptexp("--scene", "cornell", "--device", "cpu", "--width", "64", "--height", "64",
                                 "--spp", "1", "-q", "-o", name, preexec_fn=lambda: resource.setrlimit(
                                     resource.RLIMIT_FSIZE, (4096, 4096)))
            self.assert_refused(run, f"cannot write {name}: File too large")
            self.assertEqual(self.files(), ["odd.xml", "right.exr"])
        (self.folder / "r.csv").write_text("a,b\n" + "1,2\n" * 1000)
        for option, name in (("--stats", "s.json"), ("--csv", "n.csv")):
            run = self.run_ptexp(*self.scene, "-q", option, name, preexec_fn=lambda: resource.setrlimit(
                resource.RLIMIT_FSIZE, (4000 if option == "--stats" else 1000,) * 2))
            self.assertEqual(run.returncode, 2)
            self.assertIn("File too large", run.stderr)
            self.assertEqual((self.folder / name).stat().st_size if (self.folder / name).exists() else 0, 0)

    def test_one_output_does_not_lose_the_others(self):
        for missing in ("image", "json", "csv"):
            folders = {name: self.folder / name for name in ("image", "json", "csv")}
            for folder in folders.values():
                folder.mkdir(exist_ok=True)
            process = subprocess.Popen(
                [PTEXP, "--scene", "cornell", "--device", "cpu", "--width", "32", "--height", "32", "--time-limit",
                 "1.5", "-o", "image/a.exr", "--stats", "json/s.json", "--csv", "csv/r.csv"],
                cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            time.sleep(0.7)
            folders[missing].rmdir()
            printed, errors = process.communicate()
            self.assertEqual("wrote image/a.exr\n" in printed, missing != "image")
            with self.subTest(missing=missing):
                self.assertEqual(process.returncode, 2)
                self.assertRegex(errors, rf"^ptexp: error: [^\n]*{missing}/[^\n]*\n$")
                for name, file in (("image", "a.exr"), ("json", "s.json"), ("csv", "r.csv")):
                    self.assertEqual((folders[name] / file).exists(), name != missing, name)
                    (folders[name] / file).unlink(missing_ok=True)

    def test_pipes(self):
        pipe = self.folder / "p.exr"
        os.mkfifo(pipe)
        process = subprocess.Popen([PTEXP, *self.scene, "-q", "-o", pipe], stderr=subprocess.PIPE,
                                   text=True, cwd=self.folder)
        time.sleep(0.5)
        (self.folder / "a.exr").write_bytes(pipe.read_bytes())
        self.assertEqual((process.communicate()[1], process.returncode), ("", 0))
        pipe.unlink()
        self.assert_image()
        os.mkfifo(pipe)
        for number in (signal.SIGTERM, signal.SIGINT):
            process = subprocess.Popen([PTEXP, *self.scene, "-q", "-o", pipe], stderr=subprocess.PIPE,
                                       text=True, cwd=self.folder)
            time.sleep(1.5)
            self.assertIsNone(process.poll(), "it waits for a reader")
            process.send_signal(number)
            self.assertIn("nobody reads this pipe", process.communicate(timeout=20)[1])
            self.assertEqual(process.returncode, 2)

    def test_names_move_no_cursor(self):
        (self.folder / "e.obj").write_bytes(
            b"v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\033]52;c;cm0gLXJm\007\xe2\x80\xaeb\xff\xc3\xa9\nf 1 2 3\n")
        bad = "x\x1b[31m\u202e\u00e9"
        runs = [self.run_ptexp("--scene", "e.obj", "--device", "cpu", "--width", "8", "--height", "8", "--spp", "1",
                               "-o", "e.exr", "--stats", bad, encoding="utf-8"),
                self.run_ptexp("--scene", bad + ".xml"), self.run_ptexp("--spp", bad),
                self.run_ptexp(bad), self.run_ptexp("--" + bad), self.run_ptexp("compare", bad, bad),
                self.run_ptexp("resume", bad), self.run_ptexp("merge", bad + ".exr", bad),
                self.run_ptexp("trace", "--mesh", bad, "--rays", bad),
                self.run_ptexp("--scene", "e.obj", "-o", bad + ".exr", "--device", "cpu", "--spp", "1")]
        for run in runs:
            shown = run.stdout + run.stderr
            self.assertNotRegex(shown, "[\x00-\x08\x0b-\x1f\x7f-\x9f\u202e]", run.args)
            self.assertTrue(shown)
        self.assertIn("a?]52;c;cm0gLXJm??b?\u00e9", runs[0].stderr)
        self.assertIn("x?[31m?\u00e9.exr", runs[-1].stdout)

    def test_quiet_leaves_out_what_is_said_of_the_scene(self):
        self.assertRegex(self.run_ok(*self.scene).stderr, "^ptexp: warning: [^\n]*hair")
        run = self.run_ok(*self.scene, "-q")
        self.assertEqual(run.stdout + run.stderr, "")

    def test_many_warnings_and_long_ones(self):
        shapes = "".join(f'<shape type="hair{i}"/>' for i in range(3000))
        (self.folder / "many.xml").write_text(f'<scene version="3.0.0"><shape type="sphere"/>{shapes}</scene>')
        lines = self.run_ok(*self.scene, "--scene", "many.xml").stderr.splitlines()
        self.assertLess(len(lines), 30)
        self.assertRegex(lines[-1], r"warning: \d\d\d warnings more, of kinds that were shown")
        (self.folder / "long.xml").write_text(f'<scene version="3.0.0"><shape type="{"y" * 5_000_000}"/></scene>')
        run = self.run_ptexp(*self.scene, "--scene", "long.xml", "--strict")
        self.assert_refused(run, "yyy... yyy")
        self.assertLess(len(run.stderr), 5000)

    def test_the_table_has_the_numbers_of_the_statistics(self):
        """By their values: what is printed of a run, and what its file has of it."""
        out = self.run_ok("--scene", "statue:2K", "--device", "cpu", "--width", "48", "--height", "32",
                          "--mode", "wavefront", "--repeat", "3", "--target-error", "0.3", "-o", "t.exr",
                          "--stats", "t.json").stdout
        known = json.loads((self.folder / "t.json").read_text())

        def numbers(name):
            return [float(text.replace(",", "")) for text in re.findall(
                r"[\d,.]+", re.search(rf"^ *{name} .*$", out, re.M)[0].replace(name, "", 1))]

        for stage in known["stages"]:
            time_ms = stage["time_ms"]
            share = 100 * time_ms["median"] / known["time_ms"]["kernel"]["median"]
            for shown, right, step in zip(numbers(stage["stage"]), (
                    time_ms["median"], time_ms["min"], time_ms["max"], share, stage["launches"]),
                    (1e-3, 1e-3, 1e-3, 0.1, 0)):
                self.assertAlmostEqual(shown, right, delta=0.51 * step, msg=stage["stage"])
        kernel = known["time_ms"]["kernel"]
        for shown, right, step in zip(numbers("kernel time"), (kernel["median"], kernel["min"], kernel["max"],
                                                               known["launches"]), (1e-3,) * 3 + (0,)):
            self.assertAlmostEqual(shown, right, delta=0.51 * step)
        counts, rates = known["counts"], known["rates"]
        self.assertEqual(counts["paths"], 48 * 32 * known["samples_done"])
        rays = counts["rays"] + counts["shadow_rays"]
        for name, count, rate in (("paths", counts["paths"], rates["mpaths_per_s"]),
                                  ("rays", rays, rates["mrays_per_s"])):
            self.assertEqual(numbers(name)[0], count)
            self.assertAlmostEqual(numbers(name)[1], rate, delta=0.0051)
            self.assertAlmostEqual(rate, count / kernel["median"] / 1e3, delta=1e-6 * rate)
        self.assertEqual(numbers("of them shadow"), [counts["shadow_rays"]])
        self.assertEqual(numbers("waves"), [known["waves"]])
        self.assertAlmostEqual(numbers("standard error")[0], known["relative_error"], delta=5.1e-7)
        last = re.search(r"scene ([\d.]+) ms, set-up ([\d.]+) ms, transfer ([\d.]+) ms, writing the image "
                         r"([\d.]+) ms", out)
        for shown, name in zip(last.groups(), ("scene", "setup", "transfer", "image_write")):
            self.assertAlmostEqual(float(shown), known["time_ms"][name], delta=0.051)
        scene = known["scene"]
        self.assertIn(f"scene: {scene['triangles']} triangles, ", out)
        self.assertRegex(out, rf"tree: \S+, {scene['tree_nodes']} nodes, depth {scene['tree_depth']}, SAH cost "
                              rf"{scene['sah_cost']:.1f}, {scene['bytes_per_triangle']:.1f} bytes per triangle, ")
        header = (self.folder / "t.exr").read_bytes()
        self.assertIn(b"ptexp.relative_error\0string\0", header)
        text = re.search(rb"ptexp.relative_error\0string\0....([\d.e-]+)", header, re.S)[1].decode()
        self.assertAlmostEqual(float(text), known["relative_error"], delta=1e-5 * known["relative_error"])


class Interruption(CommandLine):
    def start(self, *arguments):
        """A render at work; it is gone when the test ends."""
        return self.start_command("--device", "cpu", *arguments)

    def start_command(self, *arguments):
        process = subprocess.Popen(
            [PTEXP, *arguments], cwd=self.folder, stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def end(self, process, *signals, after_s=1.5):
        """Sends the signals once the process has computed for so long; what it prints. It answers
        within a second; eight allow for a machine that is busy."""
        self.wait_for_work(process, after_s)
        begin = time.monotonic()
        for number in signals:
            process.send_signal(number)
            time.sleep(0.02)
        out, err = process.communicate(timeout=TIMEOUT_S)
        self.assertLess(time.monotonic() - begin, 8)
        self.assertEqual(process.returncode, 128 + signals[0], out + err)
        self.assertRegex(err, r"(?i)interrupt")
        return err

    def test_a_signal_keeps_the_samples_so_far(self):
        for mode in MODES:
            for number in (signal.SIGINT, signal.SIGTERM):
                with self.subTest(mode=mode, number=number):
                    name = f"{mode}-{number}.ppm"
                    process = self.start("--mode", mode, "--width", "200", "--height", "100",
                                         "--spp", "1000000", "--output", name)
                    err = self.end(process, number)
                    self.assertRegex(err, r"\d[\d,]* (of|samples)")
                    width, height, values = read_ppm(self.folder / name)
                    self.assertEqual((width, height), (200, 100))
                    self.assertGreater(len(set(values)), 20, "the samples are in the image")
                    self.assertIn(name, self.files())
                    self.assertEqual([n for n in self.files() if not n.endswith(".ppm")], [])

    def test_what_was_rendered_is_told(self):
        process = self.start("--scene", "cornell", "--width", "32", "--height", "32", "--spp", "3000000", "--repeat",
                             "2", "--output", "a.exr", "--stats", "s.json", "--csv", "r.csv")
        err = self.end(process, signal.SIGINT)
        known = json.loads((self.folder / "s.json").read_text())
        self.assertFalse(known["complete"])
        self.assertRegex(err, rf"interrupted: image has {known['samples_done']} of 3000000 samples per pixel; no "
                              r"row appended to r\.csv\n$")
        self.assertGreater(known["samples_done"], 0)
        self.assertEqual(self.files(), ["a.exr", "s.json"], "rows are for comparing")

    def test_sigusr1_says_why_nothing_is_kept(self):
        process = self.start("--width", "200", "--height", "100", "--spp", "1000000", "--output",
                             "a.ppm")
        err = self.end(process, signal.SIGUSR1)
        self.assertIn("interrupted: SIGUSR1 keeps samples where there is a --checkpoint; no image "
                      "written", err)
        self.assertEqual(self.files(), [])

    def test_advice_ends_by_a_signal(self):
        process = self.start_command("advise", "cornell", "--device", "cpu", "--spp", "1000")
        self.end(process, signal.SIGINT)

    def test_a_calibration_ends_by_a_signal(self):
        process = self.start_command("calibrate", "--device", "cpu")
        self.end(process, signal.SIGINT)
        self.assertEqual(self.files(), [])

    def test_more_signals_do_not_lose_the_image(self):
        process = self.start("--width", "200", "--height", "100", "--spp", "1000000",
                             "--output", "twice.ppm")
        self.end(process, signal.SIGINT, signal.SIGINT, signal.SIGTERM, signal.SIGINT)
        self.assertIn("twice.ppm", self.files())

    def test_a_batch_is_not_waited_for(self):
        for mode in MODES:
            with self.subTest(mode=mode):
                process = self.start("--mode", mode, "--scene", "boxes", "--width", "32",
                                     "--height", "32", "--spp", "80000", "--output", f"{mode}.ppm")
                err = self.end(process, signal.SIGINT)
                # A slow machine may be in its first batch.
                none = "no sample was finished" in err
                self.assertEqual(self.files().count(f"{mode}.ppm"), 0 if none else 1, err)

    def test_nor_is_the_turn_of_markov_chains(self):
        for mode in MODES:
            for after_s in (0.5, 4):  # before the first paths of the bootstrap are there, and later
                with self.subTest(mode=mode, after_s=after_s):
                    process = self.start("--mode", mode, "--scene", "boxes", "--integrator", "mlt",
                                         "--width", "200", "--height", "100", "--spp", "20000",
                                         "--output", f"{mode}.ppm")
                    self.end(process, signal.SIGINT, after_s=after_s)

    def test_nor_is_a_sample_of_a_large_image(self):
        for mode in MODES:
            with self.subTest(mode=mode):
                process = self.start("--mode", mode, "--scene", "boxes", "--width", "6000",
                                     "--height", "6000", "--spp", "1", "--output", "large.ppm")
                err = self.end(process, signal.SIGINT, after_s=3)
                self.assertIn("no sample was finished", err)
                self.assertEqual(self.files(), [])

    def test_nor_is_a_tree(self):
        process = self.start("--scene", "terrain:4M", "--output", "tree.ppm")
        err = self.end(process, signal.SIGTERM)
        self.assertIn("no image written", err)
        self.assertEqual(self.files(), [])

    def test_nor_are_other_commands(self):
        for name in "ab":
            (self.folder / f"{name}.ppm").write_bytes(b"P6 4000 3000 255\n" +
                                                      os.urandom(3 * 4000 * 3000))
        self.run_ok("rays", "--scene", "boxes", "--size", "64", "--output", "few")
        before = self.files()
        for arguments in [["compare", "a.ppm", "b.ppm"],
                          ["compact", "--device", "cpu", "--repeat", "1000000"],
                          ["trace", "--device", "cpu", "--mesh", "terrain:4M", "--rays", "few"],
                          ["trace", "--device", "cpu", "--mesh", "boxes", "--rays", "few",
                           "--repeat", "1000000"],
                          ["rays", "--scene", "terrain:4M", "--output", "many"],
                          ["rays", "--scene", "boxes", "--kind", "diffuse", "--size", "4096",
                           "--output", "many"]]:
            with self.subTest(arguments=arguments):
                self.end(self.start_command(*arguments), signal.SIGTERM, after_s=1)
                self.assertEqual(self.files(), before)

    def wait_for_work(self, process, seconds):
        give_up = time.monotonic() + TIMEOUT_S
        while process.poll() is None and processor_time_s(process.pid) < seconds:
            self.assertLess(time.monotonic(), give_up)
            time.sleep(0.05)


if __name__ == "__main__":
    unittest.main()
