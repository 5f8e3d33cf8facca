"""Memory, errors, threads, progress, Ctrl-C, arrays, tracing, comparing."""
import gc
import os
import resource
import shutil
import signal
import subprocess
import sys
import textwrap
import threading
import time
import unittest
import warnings

from ptexp_package import TestCase, np, ptexp, room

SMALL = {"width": 32, "height": 24, "spp": 2}


def resident_bytes():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


class Memory(TestCase):
    def test_a_hundred_renders_leave_nothing(self):
        scene = ptexp.load("cornell", width=256, height=256, spp=1)
        for seed in range(10):
            ptexp.render(scene, seed=seed).array  # caches fill
        gc.collect()
        before = resident_bytes()
        for seed in range(100):
            image = ptexp.render(scene, seed=seed, aov="depth")
            image.aovs["depth"], image.array, image.stats
        gc.collect()
        grown = resident_bytes() - before
        # An image with its layer is a MiB.
        self.assertLess(grown, 30 << 20, f"{grown >> 20} MiB more")

    def test_an_array_outlives_its_image(self):
        image = ptexp.render("cornell", **SMALL)
        expected = image.array.copy()
        array, references = image.array, sys.getrefcount(image._native)
        more = [image.array for _ in range(5)]
        self.assertGreater(sys.getrefcount(image._native), references)
        del more
        self.assertEqual(sys.getrefcount(image._native), references)
        del image
        gc.collect()
        self.assertTrue((array == expected).all())

    def test_no_copy(self):
        image = ptexp.render("cornell", **SMALL)
        image.array[3, 4] = (1, 2, 3)
        for other in (image.array, np.asarray(image), np.from_dlpack(image)):
            self.assertTrue((other[3, 4] == (1, 2, 3)).all())
            self.assertTrue(np.shares_memory(other, image.array))
            self.assertEqual((other.dtype, other.shape), (np.float32, (24, 32, 3)))
        self.assertEqual(np.asarray(image, dtype=np.float64).dtype, np.float64)
        self.assertFalse(np.shares_memory(np.array(image, copy=True), image.array))
        self.assertTrue(np.shares_memory(image.__array__(np.float32, copy=False), image.array))
        with self.assertRaisesRegex(ValueError, "needs a copy"):
            image.__array__(np.float64, copy=False)
        self.assertEqual(tuple(image.__dlpack_device__()), (1, 0))


class Errors(TestCase):
    def test_options(self):
        scene = ptexp.load("cornell", **SMALL)
        for options, message in (({"max_dept": 3}, "max_depth"), ({"max_depth": 0}, "--max-depth 0"),
                                 ({"mode": "fast"}, "--mode fast"), ({"strict": True}, "ptexp.load"),
                                 ({"kernel": "loop", "mode": "wavefront"}, "--kernel"),
                                 ({"counters": 1}, "--counters"), ({"define": "a=1"}, "--define"), ({"look_from": (1, 2)}, "--look-from"),
                                 ({"output": "image.gif"}, "gif")):
            with self.subTest(options), self.assertRaisesRegex(ptexp.Error, message):
                ptexp.render(scene, **options)
        with self.assertRaises(ValueError):
            ptexp.render(scene, spp=0)
        self.assertEqual(ptexp.render(scene).shape, (24, 32, 3))  # goes on

    def test_files_and_lines(self):
        path = self.write("bad.xml", '<scene version="3.0.0">\n<shape type="cube">\n'
                          '<transform name="to_world"><scale value="0"/></transform></shape></scene>')
        with self.assertRaises(ptexp.Error) as raised:
            ptexp.load(path)
        self.assertEqual((raised.exception.file, raised.exception.line), (str(path), 3))
        self.assertNotIsInstance(raised.exception, ValueError)
        with self.assertRaisesRegex(ptexp.Error, "missing.xml"):
            ptexp.load(self.folder / "missing.xml")

    def test_warnings(self):
        path = self.write("odd.xml", room().replace("</scene>", '<shape type="hair"/></scene>'))
        with self.assertWarnsRegex(ptexp.SceneWarning, "hair") as caught:
            ptexp.load(path)
        self.assertEqual(caught.filename, __file__)
        with self.assertWarns(ptexp.SceneWarning):
            ptexp.load(path, strict=False)
        with self.assertRaisesRegex(ptexp.Error, "hair"):
            ptexp.load(path, strict=True)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with self.assertRaises(ptexp.SceneWarning):
                ptexp.load(path)


class Work(TestCase):
    def test_threads(self):
        # Each of its own scene, and all of one.
        for shared in (False, True):
            common = ptexp.load("cornell", **SMALL)
            images = {}

            def render(seed):
                scene = common if shared else ptexp.load("cornell", **SMALL)
                images[seed] = ptexp.render(scene, seed=seed).array.copy()

            threads = [threading.Thread(target=render, args=(seed,)) for seed in range(4)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            for seed, image in images.items():
                self.assert_same_bits(image, ptexp.render("cornell", **SMALL, seed=seed))

    def test_the_lock_is_released(self):
        ticks, ended = [], threading.Event()

        def tick():
            while not ended.is_set():
                ticks.append(time.monotonic())
                time.sleep(0.005)

        thread = threading.Thread(target=tick)
        thread.start()
        ptexp.render("cornell", width=64, height=64, time_limit=1.0)
        ended.set()
        thread.join()
        self.assertGreater(len(ticks), 20)

    def test_progress(self):
        calls = []
        ptexp.render("cornell", **SMALL, progress=lambda done, total: calls.append((done, total)))
        self.assertEqual(calls[-1], (32 * 24 * 2, 32 * 24 * 2))
        calls.clear()
        ptexp.render("cornell", width=64, height=64, time_limit=0.7, spp=10**6,
                     progress=lambda done, total: calls.append((done, total)))
        self.assertEqual(len(calls), len(set(calls)), "told twice")

        def refuse(done, total):
            raise ZeroDivisionError("enough")

        begin = time.monotonic()
        with self.assertRaisesRegex(ZeroDivisionError, "enough"):
            ptexp.render("cornell", width=512, height=512, spp=100000, progress=refuse)
        self.assertLess(time.monotonic() - begin, 60)

    def test_ctrl_c(self):
        program = textwrap.dedent("""
            import sys
            sys.path[:0] = [p for p in sys.argv[1].split(":") if p]
            import ptexp
            scene = ptexp.load("cornell", width=512, height=512, spp=100000)
            print("ready", flush=True)
            try:
                ptexp.render(scene)
            except KeyboardInterrupt:
                print(ptexp.render(scene, spp=1, width=8, height=8).shape, flush=True)
        """)
        path = os.environ.get("PTEXP_PYTHON_PATH", "")
        process = subprocess.Popen([sys.executable, "-c", program, path], stdout=subprocess.PIPE, text=True)
        self.assertEqual(process.stdout.readline(), "ready\n")
        time.sleep(0.7)
        begin = time.monotonic()
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.communicate(timeout=60)[0], "(8, 8, 3)\n")
        self.assertEqual(process.returncode, 0)
        self.assertLess(time.monotonic() - begin, 30)


def run_python(program, *, timeout=60, **popen):
    """A Python of its own, with the package; what it prints."""
    head = f"import sys; sys.path[:0] = {[p for p in [os.environ.get('PTEXP_PYTHON_PATH')] if p]!r}; import ptexp\n"
    return subprocess.run([sys.executable, "-c", head + textwrap.dedent(program)], capture_output=True,
                          text=True, timeout=timeout, check=False, **popen)


class NothingIsLost(TestCase):
    """Whatever is raised after a sample was finished has the image."""

    def test_by_progress(self):
        class Slotted(Exception):
            __slots__ = ()

        def refuse(done, total):
            if done:
                raise ZeroDivisionError("enough")

        path = self.folder / "part.exr"
        with self.assertRaisesRegex(ZeroDivisionError, "enough") as raised:
            ptexp.render("cornell", width=96, height=96, spp=100000, progress=refuse, output=path,
                         stats=self.folder / "s.json")
        image = raised.exception.image
        self.assertLess(image.stats["samples_done"], 100000)
        self.assertFalse(image.stats["complete"])
        self.assert_same_bits(image.array, ptexp.read_image(path).array)
        samples = image.stats["samples_done"]
        self.assert_same_bits(image.array, ptexp.render("cornell", width=96, height=96, spp=samples).array)
        self.assertTrue((self.folder / "s.json").exists())

    def test_by_a_warning(self):
        # A checkpoint that cannot be written at the end is one.
        # (On a CPU, whose batches end before that.)
        folder, size = self.folder / "gone", {"width": 96, "height": 96, "spp": 300, "device": "cpu"}
        folder.mkdir()
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with self.assertRaisesRegex(ptexp.SceneWarning, "--checkpoint: cannot write") as raised:
                ptexp.render("cornell", **size, checkpoint=folder / "c.exr",
                             progress=lambda done, total: shutil.rmtree(folder, ignore_errors=True))
        self.assert_same_bits(raised.exception.image.array, ptexp.render("cornell", **size).array)

    def test_by_files_that_cannot_be_written(self):
        # The folders vanish while it renders: each file is tried, and each is named.
        a, b = self.folder / "a", self.folder / "b"
        a.mkdir(), b.mkdir()

        def remove(done, total):
            for folder in (a, b):
                if folder.exists():
                    folder.rmdir()

        with self.assertRaises(ptexp.Error) as raised:
            ptexp.render("cornell", **SMALL, output=a / "i.exr", stats=b / "s.json", csv=self.folder / "r.csv",
                         progress=remove)
        self.assertIn(str(a / "i.exr"), str(raised.exception))
        self.assertIn(str(b / "s.json"), str(raised.exception))
        self.assertEqual(len((self.folder / "r.csv").read_text().splitlines()), 2)
        raised.exception.image.save(self.folder / "late.exr")

    def test_by_ctrl_c(self):
        done = run_python("""
            import os, signal
            def interrupt(done, total):
                if done:
                    os.kill(os.getpid(), signal.SIGINT)
            try:
                ptexp.render("cornell", width=96, height=96, spp=100000, progress=interrupt, output="a.exr")
            except KeyboardInterrupt as error:
                print(0 < error.image.stats["samples_done"] < 100000, error.image.array.shape)
            # At its very end the image is complete.
            def late(done, total):
                if done == total:
                    os.kill(os.getpid(), signal.SIGINT)
            try:
                ptexp.render("cornell", width=32, height=32, spp=2, progress=late)
            except KeyboardInterrupt as error:
                print(error.image.stats["complete"])
        """, cwd=self.folder)
        self.assertEqual(done.stdout, "True (96, 96, 3)\nTrue\n", done.stderr)
        self.assertTrue((self.folder / "a.exr").exists())


class Ends(TestCase):
    def test_an_interpreter_ends_beside_work(self):
        """Daemon threads that render, load or save are no reason to abort."""
        for work in ("ptexp.render('cornell', width=256, height=256, spp=100000)",
                     "while True: ptexp.load('cornell')",
                     "image = ptexp.render('cornell', width=8, height=8, spp=1)\nwhile True: image.save('x.exr')",
                     "while True: ptexp.render('cornell', width=8, height=8, spp=1).stats",
                     "while True:\n try: ptexp.load('missing.obj')\n except ptexp.Error: pass"):
            with self.subTest(work):
                begin = time.monotonic()
                done = run_python(f"""
                    import threading, time
                    class Slow:  # the end takes long enough for all threads to come back to it
                        def __del__(self, sleep=time.sleep):
                            sleep(0.5)
                    slow = Slow()
                    slow.me = slow
                    def work():
                        exec({work!r}, dict(ptexp=ptexp))
                    for _ in range(2):
                        threading.Thread(target=work, daemon=True).start()
                    time.sleep(0.7)
                    print("end", flush=True)
                """, cwd=self.folder)
                self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "end\n", ""))
                self.assertLess(time.monotonic() - begin, 30)

    def test_an_interpreter_ends_while_work_runs_python_code(self):
        """Daemon threads in a warning's or a progress function, which C++ called."""
        warned = self.folder / "warned.obj"
        warned.write_text("mtllib missing.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        long = "'cornell', width=256, height=256, spp=100000"
        for name, work in (("_errors.warn", f"ptexp.load({str(warned)!r})"),
                           ("progress", f"ptexp.render({long}, progress=ptexp.progress)")):
            with self.subTest(name):
                done = run_python(f"""
                    import threading, time
                    import ptexp._errors
                    called = threading.Event()
                    def slow(*arguments):
                        called.set()
                        while True:
                            pass
                    ptexp.{name} = slow
                    class Slow:  # the end takes long enough for the thread to ask for the lock
                        def __del__(self, sleep=time.sleep):
                            sleep(0.2)
                    slow_end = Slow()
                    slow_end.me = slow_end
                    threading.Thread(target=lambda: {work}, daemon=True).start()
                    print(called.wait(20), flush=True)
                """, cwd=self.folder)
                self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "True\n", ""))

    def test_a_saver_beside_a_reader(self):
        image = ptexp.render("cornell", **SMALL)
        ends = threading.Event()
        problems = []

        def read():
            while not ends.is_set():
                image._stats = None
                exposure = image.stats["used"]["exposure"]
                if exposure not in (None, 1.5, -2.0):
                    problems.append(exposure)

        thread = threading.Thread(target=read)
        thread.start()
        for exposure in (1.5, -2.0) * 50:
            image.save(self.folder / "a.ppm", exposure=exposure)
        ends.set()
        thread.join()
        self.assertEqual(problems, [])

    def test_two_scenes_are_loaded_at_once(self):
        """Each has the hash of its own files."""
        paths = [self.write(f"{name}.xml", room(red=red)) for name, red in (("a", 0.25), ("b", 0.5))]
        hashes = [ptexp.render(path, **SMALL).metadata["ptexp.scene_hash"] for path in paths]
        self.assertNotEqual(*hashes)
        found = [set(), set()]

        def load(which):
            for _ in range(20):
                found[which].add(ptexp.render(paths[which], width=2, height=2, spp=1).metadata["ptexp.scene_hash"])

        threads = [threading.Thread(target=load, args=(which,)) for which in (0, 1)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(found, [{hashes[0]}, {hashes[1]}])


class Texts(TestCase):
    def test_that_are_no_utf8(self):
        folder = os.fsencode(self.folder)
        with open(folder + b"/a.obj", "wb") as file:
            file.write(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl caf\xe9\x1b[31m\nf 1 2 3\n")
        with self.assertWarnsRegex(ptexp.SceneWarning, r"'caf\?\?\[31m' is not defined"):
            ptexp.load(self.folder / "a.obj")
        with open(folder + b"/b.obj", "wb") as file:
            file.write(b"mtllib b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl caf\xe9\nf 1 2 3\n")
        with open(folder + b"/b.mtl", "wb") as file:
            file.write(b"newmtl caf\xe9\nKd 0.5 0.5 0.5\n")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            scene = ptexp.load(self.folder / "b.obj")
        self.assertTrue(any("caf" in name for name in scene.params), list(scene.params))
        str(scene.params)
        with open(folder + b"/c.xml", "wb") as file:
            file.write(b'<scene version="3.0.0"><shape type="caf\xe9"><bsdf type="none\xff"/></shape><bad\xfe/></scene>')
        with self.assertRaises(ptexp.Error), warnings.catch_warnings():
            warnings.simplefilter("error")
            try:
                ptexp.load(self.folder / "c.xml", strict=True)
            except ptexp.SceneWarning as warning:
                raise ptexp.Error(str(warning))

    def test_names_of_files(self):
        image = ptexp.render("cornell", **SMALL)
        for name in ("a\0.exr", os.fsdecode(b"caf\xe9.exr")):
            for use in (lambda: image.save(self.folder / name), lambda: ptexp.read_image(name),
                        lambda: ptexp.load(name), lambda: ptexp.render("cornell", **SMALL, output=name),
                        lambda: ptexp.render("cornell", **SMALL, stats=name)):
                with self.subTest(name), self.assertRaisesRegex(ptexp.Error, "expected text without"):
                    use()
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_long_messages(self):
        with self.assertRaises(ptexp.Error) as raised:
            ptexp.load("x" * 5_000_000 + ".xml")
        self.assertLess(len(str(raised.exception)), 5000)


class Indices(TestCase):
    def test_what_is_none(self):
        vertices = np.eye(3, dtype=np.float32)
        for wrong in (2**32 + 2, -1, 2**40, float("nan"), float("inf"), 1e20, 0.5, -0.25, 2**70, -(2**70)):
            for made in (lambda x: [[0, 1, x]], lambda x: np.array([[0, 1, x]])):
                with self.subTest(wrong), self.assertRaisesRegex(ValueError, "expected whole numbers from 0 to"):
                    ptexp.Mesh(vertices, made(wrong), device="cpu")
                with self.subTest(wrong), self.assertRaisesRegex(ValueError, "expected whole numbers from 0 to"):
                    ptexp.Scene.from_dict({"type": "scene", "m": {"type": "mesh", "vertices": vertices,
                                                                  "triangles": made(wrong)}})
        for many in ([[0, 1, 2], [3, -4, 5]], [[0, 1, 2], [3, 2**70, 5]], [[0, 1, 2], [3, 0.5, 5]]):
            with self.assertRaisesRegex(ValueError, f"the index {many[1][1]}; expected"):
                ptexp.Mesh(np.zeros((9, 3)), many, device="cpu")
        for wrong in (np.array([[0, 1, 2j]]), np.array([["0", "1", "2"]])):
            with self.assertRaisesRegex(ValueError, "expected numbers"):
                ptexp.Mesh(vertices, wrong, device="cpu")
        for kind in (np.int8, np.uint8, np.int64, np.uint64, np.float32, np.float64, object):
            mesh = ptexp.Mesh(vertices, np.array([[0, 1, 2]], dtype=kind), device="cpu")
            hits = ptexp.trace(mesh, [[1, 1, 1, -1, -1, -1]])
            self.assertAlmostEqual(float(hits.t[0]), 2 / 3, places=6)
        with self.assertRaisesRegex(ptexp.Error, "has vertex 4294967295"):
            ptexp.Mesh(vertices, [[0, 1, 2**32 - 1]], device="cpu")


class Rays(TestCase):
    VERTICES = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 1]], dtype=np.float32)
    TRIANGLES = np.array([[0, 1, 2], [1, 3, 2]])

    def test_against_the_formula(self):
        generator = np.random.default_rng(1)
        origins = generator.uniform(-1, 2, (5000, 3)) + (0, 0, 3)
        directions = np.c_[generator.uniform(-0.5, 0.5, (5000, 2)), -np.ones(5000)]
        rays = np.c_[origins, directions].astype(np.float32)
        expected = self.brute_force(rays.astype(np.float64))
        for accel in ("auto", "brute", "bvh2", "cwbvh"):
            hits = ptexp.trace((self.VERTICES, self.TRIANGLES), rays, device="cpu", accel=accel)
            found = np.isfinite(hits.t)
            # Rays through an edge may go either way.
            self.assertLess((found != np.isfinite(expected[0])).mean(), 0.002)
            both = found & np.isfinite(expected[0]) & (hits.primitive == expected[1])
            self.assertGreater(both.sum(), 300)
            np.testing.assert_allclose(hits.t[both], expected[0][both], rtol=1e-5)
            np.testing.assert_allclose(hits.uv[both], expected[2][both], atol=1e-5)

    def brute_force(self, rays):
        best = np.full(len(rays), np.inf)
        primitive = np.full(len(rays), 0xFFFFFFFF)
        uv = np.zeros((len(rays), 2))
        for number, triangle in enumerate(self.TRIANGLES):
            a, b, c = self.VERTICES[triangle].astype(np.float64)
            for i, ray in enumerate(rays):
                system = np.c_[b - a, c - a, -ray[3:]]
                if abs(np.linalg.det(system)) < 1e-12:
                    continue
                u, v, t = np.linalg.solve(system, ray[:3] - a)
                if u >= 0 and v >= 0 and u + v <= 1 and 0 < t < best[i]:
                    best[i], primitive[i], uv[i] = t, number, (u, v)
        return best, primitive, uv

    def test_intervals_and_any_hit(self):
        mesh = ptexp.Mesh(self.VERTICES, self.TRIANGLES, device="cpu")
        ray = [0.2, 0.2, 1, 0, 0, 0, -2, 10]  # meets z = 0 at t = 0.5
        for t_min, t_max, expected in ((0, 10, 0.5), (0.6, 10, np.inf), (0, 0.4, np.inf)):
            ray[3], ray[7] = t_min, t_max
            rays = np.array([ray], dtype=np.float32)
            self.assertEqual(ptexp.trace(mesh, rays).t[0], np.float32(expected))
            self.assertEqual(np.isfinite(ptexp.trace(mesh, rays, any_hit=True).t[0]), np.isfinite(expected))

    def test_what_is_missed(self):
        mesh = ptexp.Mesh(self.VERTICES, self.TRIANGLES, device="cpu")
        rays = np.array([[0.2, 0.3, 1, 0, 0, -1], [9, 9, 1, 0, 0, -1]], dtype=np.float32)
        hits = ptexp.trace(mesh, rays)
        self.assertEqual((hits.t.tolist(), hits.primitive.tolist()), ([1, np.inf], [0, 0xFFFFFFFF]))
        np.testing.assert_allclose(hits.uv[0], (0.2, 0.3), atol=1e-6)
        self.assertEqual(ptexp.trace(mesh, rays, any_hit=True).t.tolist(), [0, np.inf])
        with self.assertRaisesRegex(TypeError, "when it is made"):
            ptexp.trace(mesh, rays, accel="bvh2")

    def test_errors(self):
        for vertices, triangles, rays, message in (
                (self.VERTICES, [[0, 1, 9]], np.ones((1, 6)), "vertex 9"),
                (self.VERTICES, self.TRIANGLES, np.ones((1, 5)), "5 numbers"),
                (self.VERTICES, self.TRIANGLES, np.zeros((1, 6)), "no direction"),
                (self.VERTICES, np.zeros((0, 3)), np.ones((1, 6)), "no triangles"),
                (self.VERTICES[:, :2], self.TRIANGLES, np.ones((1, 6)), "vertices: 2 columns")):
            with self.assertRaisesRegex(ptexp.Error, message):
                ptexp.trace((vertices, triangles), rays, device="cpu")
        with self.assertRaises(ptexp.OptionError):
            ptexp.Mesh(self.VERTICES, self.TRIANGLES, accel="octree")


class Compare(TestCase):
    def test_numbers(self):
        a, b = np.zeros((4, 5, 3), np.float32), np.zeros((4, 5, 3), np.float32)
        b[1, 2] = (3, 0, 0)
        difference = ptexp.compare(a, b, tolerance=1)
        self.assertAlmostEqual(difference.rmse, (9 / 60) ** 0.5)
        self.assertEqual(difference.largest, 3)
        self.assertEqual((difference.differing_pixels, difference.pixels_past_tolerance), (1, 1))
        self.assertGreater(difference.flip, 0)
        self.assertEqual(ptexp.compare(b, b).flip, 0)
        with self.assertRaises(ptexp.Error):
            ptexp.compare(a, b[:3])

    def test_by_the_formulas(self):
        generator = np.random.default_rng(3)
        a, b = generator.uniform(0, 2, (2, 6, 7, 3)).astype(np.float32)
        a[0] = b[0]
        found = ptexp.compare(a, b, tolerance=0.5)
        error = a.astype(float) - b
        self.assertAlmostEqual(found.rmse, np.sqrt((error**2).mean()))
        self.assertAlmostEqual(found.relative_mse, (error**2 / (b.astype(float) ** 2 + 0.01)).mean())
        self.assertAlmostEqual(found.largest, np.abs(error).max())
        self.assertEqual(found.differing_pixels, 35)
        self.assertEqual(found.pixels_past_tolerance, (np.abs(error) > 0.5).any(axis=2).sum())
        self.assertNotEqual(found.relative_mse, ptexp.compare(b, a).relative_mse)
        for wrong in (-1, float("nan")):
            with self.assertRaisesRegex(ValueError, "tolerance"):
                ptexp.compare(a, b, tolerance=wrong)

    def test_what_is_radiance(self):
        a, b = ptexp.render("cornell", **SMALL), ptexp.render("cornell", **SMALL, seed=2)
        a.save(self.folder / "a.png"), b.save(self.folder / "b.PNG"), b.save(self.folder / "b.exr")
        png, png_b, exr = (self.folder / name for name in ("a.png", "b.PNG", "b.exr"))
        for pair, hdr in (((png, png_b), False), ((png, exr), True), ((exr, png), True), ((png, b), True),
                          ((a, b), True)):
            flips = {wanted: ptexp.compare(*pair, hdr=wanted).flip for wanted in (None, False, True)}
            self.assertEqual(flips[None], flips[hdr])
            self.assertNotEqual(flips[None], flips[not hdr])

    def test_images_and_files(self):
        image = ptexp.render("cornell", **SMALL)
        image.save(self.folder / "a.exr")
        self.assertEqual(ptexp.compare(image, self.folder / "a.exr").differing_pixels, 0)


if __name__ == "__main__":
    unittest.main()
