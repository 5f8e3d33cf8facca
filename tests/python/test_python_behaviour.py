"""Memory, errors, threads, progress, Ctrl-C, arrays, tracing, comparing."""
import gc
import os
import resource
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

    def test_images_and_files(self):
        image = ptexp.render("cornell", **SMALL)
        image.save(self.folder / "a.exr")
        self.assertEqual(ptexp.compare(image, self.folder / "a.exr").differing_pixels, 0)


if __name__ == "__main__":
    unittest.main()
