"""Renders in pieces, as a user does: several devices, checkpoints, parts, merges, faults.

The environment variable PTEXP names the executable. Images are compared bit by bit.
"""
import base64
import json
import os
import random
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
TIMEOUT_S = 300
SMALL = ["--device", "cpu", "--width", 64, "--height", 48, "--max-depth", 6, "--quiet"]


def change_attribute(file, name, old, new):
    """Changes a text in the header of a checkpoint, whose checksum then is that of the new text."""
    data = file.read_bytes()
    attributes, at = {}, 8
    while data[at]:
        key, kind, rest = data[at:].split(b"\0", 2)
        start = at + len(key) + len(kind) + 6
        at = start + int.from_bytes(rest[:4], "little")
        attributes[key] = (kind, data[start:at])
    assert attributes[name] == (b"string", old)
    attributes[name] = (b"string", new)
    checksum = b"ptexp.film.header_checksum"
    texts = b"".join(key + b"\0" + text + b"\0" for key, (kind, text) in sorted(attributes.items())
                     if kind == b"string" and key != checksum)
    attributes[checksum] = (b"string", str(zlib.crc32(texts)).encode())
    header = data[:8] + b"".join(key + b"\0" + kind + b"\0" + struct.pack("<I", len(value)) + value
                                 for key, (kind, value) in attributes.items()) + b"\0"
    # The offsets of the lines follow, the first of which comes after the last of these.
    end = at + 1
    count = (struct.unpack_from("<Q", data, end)[0] - end) // 8
    offsets = [offset + len(header) - end for offset in struct.unpack_from(f"<{count}Q", data, end)]
    file.write_bytes(header + struct.pack(f"<{count}Q", *offsets) + data[end + 8 * count:])


class Parts(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="ptexp parts ")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_ptexp(self, *arguments, **popen):
        return subprocess.run([PTEXP, *map(str, arguments)], cwd=self.folder, capture_output=True,
                              stdin=subprocess.DEVNULL, text=True, check=False, timeout=TIMEOUT_S,
                              **popen)

    def render(self, *arguments, code=0, **popen):
        run = self.run_ptexp(*arguments, **popen)
        self.assertEqual(run.returncode, code, run.stderr + run.stdout)
        return run

    def refused(self, *arguments):
        """The one error on stderr."""
        run = self.render(*arguments, code=2)
        self.assertRegex(run.stderr, r"^(ptexp: warning: [^\n]*\n)*ptexp: error: [^\n]*\n$")
        return run.stderr.splitlines()[-1]

    def assert_same_image(self, a, b):
        run = self.run_ptexp("compare", a, b)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        self.assertRegex(run.stdout, r"differing pixels +0\b")

    def header(self, name):
        """String attributes of an EXR."""
        data = (self.folder / name).read_bytes()
        return {m[1].decode(): data[m.end() + 4:m.end() + 4 + int.from_bytes(
            data[m.end():m.end() + 4], "little")].decode()
            for m in re.finditer(rb"(ptexp[\w.]+)\0string\0", data)}

    def files(self):
        return sorted(path.name for path in self.folder.iterdir())


class Devices(Parts):
    def test_any_number_makes_the_same_image(self):
        for scene in (["--scene", "spheres", "--mode", "megakernel"],
                      ["--scene", "boxes", "--aov", "albedo,variance", "--filter", "mitchell"],
                      ["--scene", "cornell", "--crop", "5,7,60,40", "--sampler", "sobol"]):
            one = [*SMALL, *scene, "--spp", 9]
            self.render(*one, "-o", "one.exr")
            for count in (2, 4):
                several = [*one, "--device", f"cpu:{count}", "-o", "several.exr", "--stats", "s.json"]
                self.render(*several)
                self.assert_same_image("several.exr", "one.exr")
                run = json.loads((self.folder / "s.json").read_text())["runs"][0]
                self.assertEqual([d["name"] for d in run["devices"]],
                                 [f"cpu:{i}" for i in range(count)])
                self.assertEqual(run["kernel_ms"], max(d["kernel_ms"] for d in run["devices"]))
                self.assertGreaterEqual(run["wall_ms"], run["kernel_ms"])

    def test_the_table_has_a_row_for_each(self):
        run = self.render(*SMALL[:-1], "--spp", 4, "--device", "cpu:3")
        self.assertEqual(len(re.findall(r"^cpu:[012] ", run.stdout, re.M)), 3, run.stdout)
        self.assertEqual(len(re.findall(r"^device cpu", run.stdout, re.M)), 3, run.stdout)

    def test_what_cannot_be_is_refused(self):
        for arguments, text in (
                (["--device", "cpu:0"], "expected auto, cpu, cpu:N"),
                (["--device", "cuda:0,x"], "expected auto, cpu, cpu:N"),
                (["--device", "cpu:2", "--mode", "serial"], "one thread"),
                (["--device", "cpu:2", "--integrator", "mlt"], "the whole image"),
                (["--integrator", "mlt", "--checkpoint", "c.exr"], "the whole image"),
                (["--checkpoint", "c.png"], "an .exr file"),
                (["--checkpoint", "c.exr,-3"], "seconds above 0"),
                (["--checkpoint", "c.exr,0"], "seconds above 0"),
                (["--checkpoint", "c.exr,-0.0"], "seconds above 0"),
                (["--checkpoint", "c.exr,1e-60"], "seconds above 0"),
                (["--part", "1/2", "--checkpoint", "c.exr", "--target-error", "0.1"],
                 "same samples"),
                (["--checkpoint", "image.exr"], "is the file of --output too"),
                (["--checkpoint", "c.exr", "--repeat", "2"], "one render"),
                (["--checkpoint", "/no/such/folder/c.exr"], "/no/such/folder"),
                (["--part", "3/2", "--checkpoint", "c.exr"], "1 <= I <= N"),
                (["--part", "1/2"], "expected --checkpoint"),
                (["--part", "1/2", "--checkpoint", "c.exr", "-o", "x.exr"], "--checkpoint alone"),
                (["--part", "1/99", "--checkpoint", "c.exr"], "48 rows"),
                (["--part", "1/2", "--checkpoint", "c.exr", "--time-limit", "1"], "same samples")):
            with self.subTest(arguments):
                self.assertIn(text, self.refused(*SMALL[2:], *arguments))
        self.assertEqual(self.files(), [])


class Checkpoints(Parts):
    def test_more_samples_are_those_of_one_render(self):
        scene = [*SMALL, "--scene", "boxes", "--aov", "depth,variance", "--seed", 5]
        self.render(*scene, "--spp", 24, "-o", "whole.exr")
        self.render(*scene, "--spp", 7, "--checkpoint", "c.exr", "-o", "a.exr")
        self.assert_same_image("c.exr", "a.exr")  # it is an image
        self.render("resume", "c.exr", "--spp", 15, "-o", "b.exr", "--device", "cpu:3")
        self.render("resume", "c.exr", "--spp", 24, "-o", "b.exr", "--mode", "megakernel")
        self.assert_same_image("b.exr", "whole.exr")
        self.assert_same_image("c.exr", "whole.exr")
        self.assertEqual(self.files(), ["a.exr", "b.exr", "c.exr", "whole.exr"])

    def test_other_samples_are_refused(self):
        self.render(*SMALL, "--spp", 8, "--checkpoint", "c.exr", "-o", "a.exr")
        for arguments, text in ((["--seed", 2], "--seed 2: c.exr was begun with 1"),
                                (["--width", 32], "--width 32: c.exr was begun with 64"),
                                (["--filter", "tent"], "--filter tent: c.exr was begun with"),
                                (["--scene", "cornell"], "--scene cornell: c.exr was begun with"),
                                (["--fov", 30], "--fov 30: c.exr was begun with none"),
                                (["--spp", 4], "pixels with 8 samples"),
                                (["--mode", "serial", "--threads", 2], "--threads 2")):
            with self.subTest(arguments):
                self.assertIn(text, self.refused("resume", "c.exr", *arguments))
        self.assertIn("no attribute ptexp.film.format", self.refused("resume", "a.exr"))
        self.assertIn("expected ptexp resume FILE".split()[0], self.refused("resume"))
        self.assertIn("missing.exr", self.refused("resume", "missing.exr"))
        self.render(*SMALL, "--spp", 8, "--sampler", "stratified", "--checkpoint", "s.exr")
        self.assertIn("stratified", self.refused("resume", "s.exr", "--spp", 16))
        # What is complete may be written once more.
        self.render("resume", "s.exr", "--spp", 8, "-o", "b.exr")
        self.render("resume", "c.exr", "-o", "b.exr")
        self.assert_same_image("a.exr", "b.exr")

    def test_a_scene_file_that_changed_is_refused(self):
        scene = self.folder / "scene.obj"
        scene.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        self.render(*SMALL, "--scene", scene.name, "--spp", 2, "--checkpoint", "c.exr")
        self.render("resume", "c.exr", "--spp", 3)
        scene.write_text("v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n")
        self.assertIn("scene hash", self.refused("resume", "c.exr", "--spp", 4))
        scene.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        self.render("resume", "c.exr", "--spp", 4)
        self.render("verify", "image.exr")

    def test_signals_leave_a_checkpoint(self):
        scene = [*SMALL, "--scene", "cornell", "--spp", 1500, "--seed", 3]
        self.render(*scene, "-o", "whole.exr")
        for sent in (signal.SIGINT, signal.SIGTERM, signal.SIGUSR1):
            with self.subTest(sent):
                for wait_s in (0.5, 2, 8):  # until a slow machine has finished a sample
                    process = subprocess.Popen(
                        [PTEXP, *map(str, scene), "--checkpoint", "c.exr", "-o", "b.exr",
                         "--device", "cpu:2"], cwd=self.folder, stderr=subprocess.PIPE, text=True)
                    time.sleep(wait_s)
                    process.send_signal(sent)
                    begin = time.monotonic()
                    _, said = process.communicate(timeout=TIMEOUT_S)
                    if process.returncode == 0:
                        self.skipTest("the machine is too fast")
                    self.assertLess(time.monotonic() - begin, 5)
                    self.assertEqual(process.returncode, 128 + sent)
                    if "no sample was finished" not in said:
                        break
                self.assertIn("ptexp resume c.exr goes on", said)
                self.render("resume", "c.exr", "-o", "b.exr")
                self.assert_same_image("b.exr", "whole.exr")

    def test_a_time_limit_is_gone_on_with(self):
        scene = [*SMALL, "--scene", "cornell", "--seed", 4]
        self.render(*scene, "--time-limit", 0.3, "--checkpoint", "c.exr", "-o", "a.exr")
        self.assert_same_image("c.exr", "a.exr")
        done = int(self.header("a.exr")["ptexp.samples_done"])
        self.assertGreater(done, 0)
        run = self.run_ptexp("resume", "c.exr", "--spp", done + 5, "--time-limit", 1e6, "-o", "b.exr")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.render(*scene, "--spp", done + 5, "-o", "whole.exr")
        self.assert_same_image("b.exr", "whole.exr")

    def test_a_full_disk_keeps_the_old_one(self):
        self.render(*SMALL, "--spp", 2, "--checkpoint", "c.exr", "-o", "a.exr")
        before = (self.folder / "c.exr").read_bytes()

        def limit_files():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # an error, as of a full disk
            resource.setrlimit(resource.RLIMIT_FSIZE, (10000, 10000))
        run = self.run_ptexp("resume", "c.exr", "--spp", 300, "--checkpoint", "c.exr,0.05", "-o",
                             "b.exr", preexec_fn=limit_files)
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertIn("ptexp: warning: --checkpoint: ", run.stderr)  # and the render went on
        self.assertEqual((self.folder / "c.exr").read_bytes(), before)
        self.assertEqual(self.files(), ["a.exr", "c.exr"])
        self.render("resume", "c.exr", "--spp", 3)

    def test_the_last_one_loses_no_image(self):
        scene = [*SMALL, "--scene", "cornell", "--spp", 1500, "--threads", 1]
        self.render(*scene, "-o", "right.exr")
        for part in ([], ["--part", "1/2"]):
            (self.folder / "cp").mkdir()
            process = subprocess.Popen(
                [PTEXP, *map(str, scene), "--checkpoint", "cp/c.exr,60",
                 *(part or ["-o", "a.exr"])], cwd=self.folder, stderr=subprocess.PIPE, text=True)
            time.sleep(0.3)
            (self.folder / "cp").rmdir()
            errors = process.communicate()[1]
            if part:  # which is the file
                self.assertRegex(errors, "^ptexp: error: cannot write cp/c.exr: [^\n]*\n$")
                self.assertEqual(process.returncode, 2)
            else:
                self.assertRegex(errors, "^ptexp: warning: --checkpoint: cannot write [^\n]*\n$")
                self.assertEqual(process.returncode, 0)
                self.assert_same_image("a.exr", "right.exr")

    def test_definitions_of_any_text(self):
        (self.folder / "s.xml").write_text("""<scene version="3.0.0"><default name="c" value="0 1 0"/>
            <default name="n" value="x"/><sensor type="perspective"/><shape type="sphere" id="$n">
            <bsdf type="diffuse"><rgb name="reflectance" value="$c"/></bsdf></shape></scene>""")
        name = "a \"quoted\" 'name' = 50% %20\n\tand more \u00e9"
        scene = [*SMALL, "--scene", "s.xml", "-D", "c=0.5 0.25 0.125", "-D", f"n={name}"]
        self.render(*scene, "--spp", 5, "-o", "right.exr")
        self.render(*scene, "--spp", 2, "-o", "a.exr", "--checkpoint", "c.exr")
        self.render("resume", "c.exr", "--spp", 5)
        self.assert_same_image("a.exr", "right.exr")
        self.assertIn("all bits are equal", self.render("verify", "a.exr", "--share", 1).stdout)
        for part in (1, 2):
            self.render(*scene, "--spp", 5, "--part", f"{part}/2", "--checkpoint", f"p{part}.exr")
        self.render("merge", "m.exr", "p1.exr", "p2.exr")
        self.assert_same_image("m.exr", "right.exr")

    def write_moving_triangle(self, name, **node):
        """A .gltf whose node is at (0, 0, 0) at 1 s and at (2, 0, -1) at 3 s."""
        data = struct.pack("<17f", 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 3, 0, 0, 0, 2, 0, -1)
        views = [(0, 36, 3, "VEC3"), (36, 8, 2, "SCALAR"), (44, 24, 2, "VEC3")]
        (self.folder / name).write_text(json.dumps({
            "asset": {"version": "2.0"}, "scenes": [{"nodes": [0, 1]}],
            "nodes": [{"mesh": 0, **node}, {"camera": 0, "translation": [0, 0, 5]}],
            "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "animations": [{"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
                            "samplers": [{"input": 1, "output": 2}]}],
            "accessors": [{"bufferView": i, "componentType": 5126, "count": count, "type": kind}
                          for i, (_, _, count, kind) in enumerate(views)],
            "bufferViews": [{"buffer": 0, "byteOffset": at, "byteLength": size} for at, size, _, _ in views],
            "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," +
                         base64.b64encode(data).decode()}]}))

    def test_a_time_belongs_to_the_scene(self):
        self.write_moving_triangle("moving.gltf")
        self.write_moving_triangle("moved.gltf", translation=[1.5, 0, -0.75])
        moving = [*SMALL, "--scene", "moving.gltf", "--default-lighting", "on"]
        self.render(*SMALL, "--scene", "moved.gltf", "--default-lighting", "on", "--spp", 6, "-o", "right.exr")
        self.render(*moving, "--time", 2.5, "--spp", 6, "-o", "a.exr")
        self.assert_same_image("a.exr", "right.exr")
        self.render(*moving, "--spp", 6, "-o", "still.exr")
        self.assertNotEqual(self.run_ptexp("compare", "still.exr", "right.exr").returncode, 0)
        self.assertEqual(self.header("a.exr")["ptexp.option.time"], "2.5")
        self.assertNotIn("ptexp.option.time", self.header("still.exr"))
        self.render(*moving, "--time", 2.5, "--animation", 0, "--spp", 2, "--checkpoint", "c.exr")
        self.assertIn("--time 2: c.exr was begun with 2.5", self.refused("resume", "c.exr", "--time", 2))
        self.assertIn("--animation 1: c.exr was begun with 0", self.refused("resume", "c.exr", "--animation", 1))
        self.render("resume", "c.exr", "--spp", 6, "--time", "2.50", "-o", "b.exr")
        self.assert_same_image("b.exr", "right.exr")
        for part, at in ((1, 1), (2, 1.5)):
            self.render(*moving, "--time", at, "--spp", 1, "--part", f"{part}/2", "--checkpoint", f"p{part}.exr")
        self.assertIn("--time 1.5, but p1.exr has 1;", self.refused("merge", "m.exr", "p1.exr", "p2.exr"))
        for arguments, text in ((["--time", "soon"], "--time soon: expected a number of seconds"),
                                (["--time", "nan"], "--time nan: expected a number of seconds"),
                                (["--animation", 0], "--animation 0: has no effect without --time"),
                                (["--time", 1, "--animation", "Run"], "--animation Run: expected name or number")):
            self.assertIn(text, self.refused(*moving, *arguments))
        self.assertIn("--time: is for scene files; 'cornell' is", self.refused(*SMALL, "--scene", "cornell", "--time", 1))

    def test_no_input_is_replaced(self):
        for part in (1, 2):
            self.render(*SMALL, "--spp", 1, "--part", f"{part}/2", "--checkpoint", f"p{part}.exr")
        before = (self.folder / "p1.exr").read_bytes()
        os.link(self.folder / "p1.exr", self.folder / "hard.exr")
        os.symlink("p1.exr", self.folder / "soft.exr")
        for out in ("p1.exr", "./p1.exr", "hard.exr", "soft.exr"):
            for command in (["merge", out, "p1.exr", "p2.exr"], ["merge", "--keep-sums", out, "p2.exr", "p1.exr"],
                            ["compare", "p1.exr", "p2.exr", "--difference", out],
                            ["resume", "p1.exr", "--checkpoint", "n.exr", "--part", "1/1", "-o", out]):
                self.assertRegex(self.refused(*command), "is the file|was begun|same file")
        self.assertEqual((self.folder / "p1.exr").read_bytes(), before)
        self.render(*SMALL, "--spp", 1, "--checkpoint", "c.exr", "-o", "a.exr")
        os.symlink("c.exr", self.folder / "link.exr")
        self.assertIn("is the file", self.refused("resume", "c.exr", "-o", "link.exr"))
        self.assertIn("is the file", self.refused("resume", "c.exr", "-o", "c.exr", "--checkpoint", "n.exr"))
        (self.folder / "s.xml").write_text('<scene version="3.0.0"><shape type="sphere"/></scene>')
        self.assertIn("which is read", self.refused(*SMALL, "--scene", "s.xml", "--stats", "s.xml"))
        self.assertTrue((self.folder / "s.xml").read_text().startswith("<scene"))

    def killed_at(self, seconds, arguments):
        """Whether the process had not ended before."""
        process = subprocess.Popen([PTEXP, *map(str, arguments)], cwd=self.folder,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        try:
            _, errors = process.communicate(timeout=seconds)
            self.assertEqual(process.returncode, 0, errors)
            return False
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            return True

    def test_killed_at_any_moment(self):
        """The file is the old one or the new one, whole, and goes on to the same bits. Moments are
        drawn from the time that a whole render takes here; one that was completed is begun anew."""
        checkpoint = self.folder / "c.exr"
        scene = [*SMALL, "--scene", "statue:30K", "--spp", 8, "--device", "cpu:2", "--width", 192,
                 "--height", 144, "--aov", "albedo,variance"]
        saved = ["--checkpoint", "c.exr,0.02", "-o", "b.exr"]
        begin = time.monotonic()
        self.render(*scene, *saved)
        whole_s = time.monotonic() - begin
        (self.folder / "b.exr").rename(self.folder / "whole.exr")
        checkpoint.unlink()
        random.seed(1)
        kills = int(os.environ.get("PTEXP_TEST_KILLS", "12"))
        found = dict.fromkeys(("no checkpoint", "a checkpoint", "one being written", "completed"), 0)
        for _ in range(kills):
            arguments = ["resume", "c.exr"] if checkpoint.exists() else scene
            if self.killed_at(random.uniform(0, whole_s), [*arguments, *saved]):
                is_torn = any(name.endswith(".tmp") for name in self.files())
                found["one being written" if is_torn else
                      "a checkpoint" if checkpoint.exists() else "no checkpoint"] += 1
            else:
                self.assert_same_image("b.exr", "whole.exr")
                self.assertEqual(self.files(), ["b.exr", "c.exr", "whole.exr"])
                checkpoint.unlink()
                found["completed"] += 1
        print(f"{kills} runs: {found}")
        self.assertGreater(found["a checkpoint"] + found["one being written"], 0)
        if kills >= 100:
            self.assertTrue(all(found.values()), found)
        self.render(*(["resume", "c.exr"] if checkpoint.exists() else scene), *saved)
        self.assert_same_image("b.exr", "whole.exr")
        self.assertEqual(self.files(), ["b.exr", "c.exr", "whole.exr"])  # no temporary file stays


class Merges(Parts):
    def make_parts(self, count, *scene, spp=6):
        names = [f"p{i}.exr" for i in range(1, count + 1)]
        for i, name in enumerate(names, 1):
            self.render(*SMALL, *scene, "--spp", spp, "--part", f"{i}/{count}", "--checkpoint", name)
        return names

    def test_parts_make_the_whole(self):
        scene = ["--scene", "boxes", "--aov", "albedo,primitive,rays", "--crop", "3,4,60,45"]
        self.render(*SMALL, *scene, "--spp", 6, "-o", "whole.exr")
        names = self.make_parts(5, *scene)
        random.seed(2)
        random.shuffle(names)
        self.render("merge", "out.exr", *names)
        self.assert_same_image("out.exr", "whole.exr")
        # What was joined can be joined, and gone on with.
        self.render("merge", "--keep-sums", "ab.exr", *names[:2], "--allow-missing")
        self.render("merge", "out.exr", "ab.exr", *names[2:])
        self.assert_same_image("out.exr", "whole.exr")
        self.render("merge", "all.exr", "--keep-sums", *names)
        self.render("resume", "all.exr", "--spp", 10, "-o", "more.exr")
        self.render(*SMALL, *scene, "--spp", 10, "-o", "whole.exr")
        self.assert_same_image("more.exr", "whole.exr")

    def test_what_is_missing_is_named(self):
        names = self.make_parts(4)
        said = self.refused("merge", "out.exr", names[0], names[2])
        self.assertIn("no file of --part 2, 4: 50 % of the samples are missing", said)
        for missing in range(1, 5):
            others = [name for i, name in enumerate(names, 1) if i != missing]
            self.assertIn(f": error: no file of --part {missing}: 25 % of the samples are missing;",
                          self.refused("merge", "out.exr", *others))
        self.assertFalse((self.folder / "out.exr").exists())
        run = self.render("merge", "out.exr", names[0], names[2], "--allow-missing")
        self.assertIn("warning: no file of --part 2, 4: 50 % of the samples are missing", run.stderr)
        self.assertEqual(self.header("out.exr")["ptexp.samples_done"], "0", "of the worst pixel")
        self.render("merge", "out.exr", *names)
        self.assertEqual(self.header("out.exr")["ptexp.samples_done"], "6")
        self.assertIn("expected at least one checkpoint", self.refused("merge", "out.exr"))

    def test_foreign_parts_are_named(self):
        names = self.make_parts(2)
        for other, text in ((["--seed", 9], "--seed 9, but p1.exr has 1"),
                            (["--width", 32], "--width 32, but p1.exr has 64"),
                            (["--scene", "cornell"], "scene")):
            self.render(*SMALL, "--spp", 6, *other, "--part", "2/2", "--checkpoint", "x.exr")
            said = self.refused("merge", "out.exr", names[0], "x.exr")
            self.assertIn(text, said)
            self.assertIn("x.exr", said)
        self.render(*SMALL, "--spp", 3, "--part", "1/2", "--checkpoint", "x.exr")
        self.assertIn("3 samples of", self.refused("merge", "out.exr", *names, "x.exr"))

    def test_a_part_rendered_twice_is_compared(self):
        names = self.make_parts(2)
        self.render("merge", "out.exr", *names, names[0])
        (self.folder / "again.exr").write_bytes((self.folder / names[0]).read_bytes())
        self.render("merge", "out.exr", *names, "again.exr")
        # A device that computes wrongly: the same header, other samples.
        self.render(*SMALL, "--spp", 6, "--part", "1/2", "--checkpoint", "bad.exr", "--seed", 2)
        change_attribute(self.folder / "bad.exr", b"ptexp.option.seed", b"2", b"1")
        said = self.refused("merge", "out2.exr", *names, "bad.exr")
        self.assertRegex(said, r"pixel \d+,\d+: differs between p1.exr and bad.exr")
        self.assertFalse((self.folder / "out2.exr").exists())


class Verification(Parts):
    def test_an_image_is_what_its_header_says(self):
        self.render(*SMALL, "--scene", "boxes", "--spp", 5, "-o", "a.exr", "--crop", "5,0,64,40")
        run = self.render("verify", "a.exr", "--share", 0.3)
        self.assertIn("all bits are equal", run.stdout)
        self.assertGreater(int(re.search(r"(\d+) pixels", run.stdout)[1]), 0.3 * 59 * 40 - 1)
        data = (self.folder / "a.exr").read_bytes()
        old = b"ptexp.option.seed\0string\0" + (1).to_bytes(4, "little")
        (self.folder / "b.exr").write_bytes(data.replace(old + b"1", old + b"2"))
        run = self.render("verify", "b.exr", "--share", 0.3, code=1)
        self.assertRegex(run.stdout, r"\d+ differ, the first at \d+,\d+")
        self.render(*SMALL, "--spp", 2, "-o", "a.png")
        self.assertIn("expected an .exr", self.refused("verify", "a.png"))


if __name__ == "__main__":
    unittest.main()
