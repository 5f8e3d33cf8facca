"""Images as values: arithmetic, views, copies, layers, PNGs, denoising; files and lines of errors; load_string."""
import copy
import gc
import os
import pickle
import subprocess
import sys
import types
import unittest
import warnings
from unittest import mock

from ptexp_package import TestCase, np, ptexp, room
from test_python_behaviour import resident_bytes

SMALL = {"width": 32, "height": 24, "spp": 2, "device": "cpu"}
ALL = ("albedo", "shading_normal", "depth", "uv", "primitive", "variance")


def srgb(linear):
    x = np.clip(linear.astype(np.float64), 0, 1)
    return np.floor(255 * np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055) + 0.5).astype(np.uint8)


class Arithmetic(TestCase):
    def test_by_numpy(self):
        a, b = (ptexp.render("cornell", **SMALL, seed=seed, aov="depth") for seed in (1, 2))
        x, y = a.array.copy(), b.array.copy()
        half = np.float32(0.5)
        with np.errstate(all="ignore"):
            cases = ((a + b, x + y), (a - b, x - y), (a * b, x * y), (a / b, x / y), (2 * a, 2 * x), (a / 3, x / np.float32(3)),
                     (1 - a, 1 - x), (a + 1, x + 1), (1 / a, 1 / x), (half * a, half * x), (-a, -x), (x * b, x * y), (a - y, x - y),
                     (a * [1, 0, 2], x * np.float32([1, 0, 2])), (sum([a, b]) / 2, (0 + x + y) / 2))
        for found, expected in cases:
            self.assertIsInstance(found, ptexp.Image)
            self.assertEqual((dict(found.aovs), found.stats, found.metadata), ({}, {}, {}))
            self.assert_same_bits(found, expected.astype(np.float32))
        self.assert_same_bits(a, x)
        for wrong in ("2", None, 2j):
            with self.assertRaises(TypeError):
                a + wrong
        for wrong in (np.zeros((24, 31, 3)), np.zeros((2, 24, 32, 3)), ptexp.render("cornell", width=8, height=8, spp=1)):
            with self.assertRaises(ValueError):
                a + wrong
        self.assertIsInstance(np.exp(a), np.ndarray)

    def test_views(self):
        image = ptexp.render("cornell", **SMALL)
        self.assertEqual((image[3].shape, image[2:5, ::2].shape, image[..., 0].shape, len(image)), ((32, 3), (3, 16, 3), (24, 32), 24))
        image[3, 4] = (1, 2, 3)
        image[10:12] = 7
        self.assertTrue((image.array[3, 4] == (1, 2, 3)).all() and (image.array[10:12] == 7).all())
        self.assertTrue(np.shares_memory(image[1:3], image.array))
        with self.assertRaises(IndexError):
            image[24]
        self.assertEqual(sum(1 for row in image), 24)


class Copies(TestCase):
    def test_that_have_all(self):
        image = ptexp.render("cornell", **SMALL, aov=ALL)
        for made in (pickle.loads(pickle.dumps(image)), copy.deepcopy(image), copy.copy(image), pickle.loads(pickle.dumps(image, 2))):
            self.assert_same_bits(made, image)
            self.assertEqual((made.metadata, made.stats), (image.metadata, image.stats))
            self.assertEqual(sorted(made.aovs), sorted(ALL))
            for name in ALL:
                self.assertEqual(made.aovs[name].dtype, image.aovs[name].dtype)
                self.assert_same_bits(made.aovs[name], image.aovs[name])
            made.array[:] = 0
            self.assertGreater(float(image.array.max()), 0)
        made = pickle.loads(pickle.dumps(image))
        for name in ("a.png", "a.exr"):
            image.save(self.folder / name)
            made.save(self.folder / f"made-{name}")
            self.assertEqual((self.folder / name).read_bytes(), (self.folder / f"made-{name}").read_bytes())

    def test_leave_nothing(self):
        image = ptexp.render("cornell", **{**SMALL, "width": 256, "height": 256}, aov="depth")

        def work(count):
            for _ in range(count):
                made = pickle.loads(pickle.dumps(image))
                (2 * made - image)[3:5], made.to_srgb(), made._repr_png_(), made.aovs["depth"]

        work(50)
        gc.collect()
        before = resident_bytes()
        work(1000)
        gc.collect()
        self.assertLess(resident_bytes() - before, 30 << 20)  # an image is 0.75 MiB

    def test_a_damaged_state(self):
        state = list(ptexp.render("cornell", **SMALL)._native.state())
        state[2] = state[2][:-1]
        with self.assertRaisesRegex(ptexp.Error, "bytes of an image; expected 9216"):
            ptexp._ptexp.image_of_state(tuple(state))


class Pictures(TestCase):
    def test_srgb_is_what_a_png_has(self):
        image = ptexp.render("cornell", **SMALL)
        for exposure in (None, 1.5, "auto", 0):
            image.save(self.folder / "a.png", exposure=exposure)
            shown = image.to_srgb(exposure=exposure)
            self.assertEqual((shown.dtype, shown.shape), (np.uint8, (24, 32, 3)))
            np.testing.assert_array_equal(srgb(ptexp.read_image(self.folder / "a.png").array), shown)
        shown[0, 0] = 1  # is its own
        with self.assertRaises(ptexp.OptionError):
            image.to_srgb(exposure="bright")
        plain = ptexp.render("cornell", **SMALL, exposure=0)
        self.assertLessEqual(np.abs(srgb(plain.array).astype(int) - plain.to_srgb()).max(), 1)

    def test_exposure_of_what_is_made_of_an_image(self):
        dark = ptexp.render("cornell", **SMALL, exposure=-3)
        np.testing.assert_array_equal((1 * dark).to_srgb(), dark.to_srgb())
        self.assertFalse((dark.to_srgb() == dark.to_srgb(exposure=0)).all())
        path = self.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")  # of a format whose pictures are measured
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            measured = ptexp.render(path, **SMALL)
        for made in (1 * measured, copy.deepcopy(measured)):
            np.testing.assert_array_equal(made.to_srgb(), measured.to_srgb())
        np.testing.assert_array_equal((4 * measured).to_srgb(exposure=0), measured.to_srgb(exposure=2))

    def test_png_in_notebooks(self):
        image = ptexp.render("cornell", **SMALL)
        (self.folder / "shown.png").write_bytes(image._repr_png_())
        image.save(self.folder / "saved.png")
        self.assert_same_bits(ptexp.read_image(self.folder / "shown.png"), ptexp.read_image(self.folder / "saved.png"))

    def test_show(self):
        image = ptexp.render("cornell", **SMALL)
        started = []
        for display, command in (({}, None), ({"DISPLAY": ":1"}, "xdg-open"), ({"WAYLAND_DISPLAY": "w"}, "xdg-open")):
            plain = {key: value for key, value in os.environ.items() if "DISPLAY" not in key}
            with mock.patch.dict(os.environ, {**plain, **display}, clear=True), \
                 mock.patch.object(subprocess, "Popen", lambda words, **_: started.append(words)):
                path = image.show(exposure=1)
            self.addCleanup(path.unlink)
            np.testing.assert_array_equal(srgb(ptexp.read_image(path).array), image.to_srgb(exposure=1))
            self.assertEqual(started, [] if command is None else [[command, str(path)]])
            started.clear()
        with mock.patch.dict(os.environ, {"DISPLAY": ":1", "PATH": ""}):  # no viewer is no error
            image.show().unlink()

    def test_show_in_a_notebook(self):
        image, shown = ptexp.render("cornell", **SMALL), []
        shell = types.ModuleType("IPython")
        shell.get_ipython = lambda: types.SimpleNamespace(kernel=1)
        display = types.ModuleType("IPython.display")
        display.Image, display.display = (lambda data, format: (data, format)), shown.append
        with mock.patch.dict(sys.modules, {"IPython": shell, "IPython.display": display}):
            self.assertIsNone(image.show())
        self.assertEqual(shown, [(image._repr_png_(), "png")])


class Files(TestCase):
    def test_layers_come_back(self):
        names = next(option for option in ptexp.options() if option["keyword"] == "aov")["help"]
        every = [name for name in ("albedo", "shading_normal", "normal", "depth", "position", "uv", "primitive", "instance", "material",
                                   "variance", "samples", "bounces", "rays", "transmittance") if name in names]
        image = ptexp.render("cornell", **SMALL, aov=every)
        image.save(self.folder / "a.exr")
        read = ptexp.read_image(self.folder / "a.exr")
        self.assertEqual(sorted(read.aovs), sorted(every))
        for name in every:
            self.assertEqual(read.aovs[name].dtype, image.aovs[name].dtype, name)
            self.assert_same_bits(read.aovs[name], image.aovs[name])
        read.save(self.folder / "b.exr")
        self.assertEqual((self.folder / "a.exr").read_bytes(), (self.folder / "b.exr").read_bytes())

    def test_a_checkpoints_sums_are_no_layers(self):
        ptexp.render("cornell", **SMALL, checkpoint=self.folder / "c.exr", aov="depth")
        self.assertEqual([name for name in ptexp.read_image(self.folder / "c.exr").aovs if name.startswith("film")], [])

    def test_arrays(self):
        pixels = np.random.default_rng(1).uniform(-1, 3, (5, 7, 3))
        layers = {"z": pixels[..., 0], "n": pixels, "id": np.arange(35).reshape(5, 7), "uv": pixels[..., :2]}
        ptexp.write_image(self.folder / "a.exr", pixels, aovs=layers, metadata={"who": "me"})
        read = ptexp.read_image(self.folder / "a.exr")
        self.assert_same_bits(read, pixels.astype(np.float32))
        self.assertEqual((sorted(read.aovs), read.metadata["who"], read.aovs["id"].dtype), (["id", "n", "uv", "z"], "me", np.uint32))
        for name, values in layers.items():
            np.testing.assert_array_equal(read.aovs[name], values.astype(read.aovs[name].dtype))
        ptexp.write_image(self.folder / "grey.exr", pixels[..., 1])
        self.assert_same_bits(ptexp.read_image(self.folder / "grey.exr"), np.repeat(pixels[..., 1:2], 3, 2).astype(np.float32))
        ptexp.write_image(self.folder / "a.png", pixels)
        np.testing.assert_array_equal(srgb(ptexp.read_image(self.folder / "a.png").array), ptexp.read_image(self.folder / "a.exr").to_srgb())
        ptexp.write_image(self.folder / "b.png", pixels, exposure=-1)
        ptexp.write_image(self.folder / "c.png", pixels / 2)
        self.assertEqual(*((self.folder / name).read_bytes() for name in ("b.png", "c.png")))
        bytes_of = np.random.default_rng(2).integers(0, 256, (6, 4, 3), dtype=np.uint8)
        ptexp.write_image(self.folder / "d.png", bytes_of)
        np.testing.assert_array_equal(srgb(ptexp.read_image(self.folder / "d.png").array), bytes_of)
        image = ptexp.render("cornell", **SMALL, aov="depth")
        ptexp.write_image(self.folder / "e.exr", image, metadata={"who": "me"})
        read = ptexp.read_image(self.folder / "e.exr")
        self.assertEqual((read.metadata, list(read.aovs)), ({**image.metadata, "who": "me"}, ["depth"]))
        for wrong in (pixels[0, 0], pixels[..., :2], np.zeros((0, 3, 3)), np.zeros((2, 2, 3, 1))):
            with self.assertRaisesRegex(ValueError, r"expected \(height, width, 3\)"):
                ptexp.write_image(self.folder / "x.exr", wrong)
        with self.assertRaisesRegex(ValueError, r"aovs\['z'\]: an array \(5,\)"):
            ptexp.write_image(self.folder / "x.exr", pixels, aovs={"z": pixels[:, 0, 0]})
        with self.assertRaisesRegex(ptexp.Error, "gif"):
            ptexp.write_image(self.folder / "x.gif", pixels)


class Denoise(TestCase):
    def test_noise_goes(self):
        size = {"width": 96, "height": 96, "device": "cpu"}
        try:
            import pyoidn  # noqa: F401
        except ImportError:
            with self.assertRaisesRegex(ptexp.Error, r"pip install ptexp\[denoise\]"):
                ptexp.denoise(ptexp.render("cornell", **SMALL))
            self.skipTest("needs pyoidn")
        truth = ptexp.render("cornell", **size, spp=1024)
        noisy = ptexp.render("cornell", **size, spp=8, aov=("albedo", "normal"))
        before, kept = ptexp.compare(noisy, truth).relative_mse, noisy.array.copy()
        self.assertLess(ptexp.compare(ptexp.denoise(noisy), truth).relative_mse, 0.2 * before)
        self.assertLess(ptexp.compare(ptexp.denoise(noisy * 1.0), truth).relative_mse, 0.4 * before)
        self.assertFalse((ptexp.denoise(noisy).array == ptexp.denoise(1 * noisy).array).all(), "guides have no effect")
        self.assert_same_bits(noisy, kept)


class Places(TestCase):
    """error.file and error.line wherever a message has them."""

    def test_of_files(self):
        folder = self.folder
        for name, text in (("m.xml", "<scene>\n<shape>\n</scene>"), ("i.xml", '<scene version="3.0.0">\n<include filename="no.xml"/></scene>'),
                           ("s.xml", '<scene version="3.0.0">\n<shape type="obj"><string name="filename" value="no.obj"/></shape></scene>'),
                           ("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\nq\n"), ("a.gltf", "{\n"),
                           ("b.gltf", '{"asset": {"version": "2.0"}, "meshes": 3}'), ("e.obj", "v 0 0 0\n"),
                           ("a.pbrt", 'WorldBegin\nShape "sphere" "float radius" [-\n')):
            self.write(name, text)
        cases = {"m.xml": ("m.xml", 3), "i.xml": ("no.xml", None), "s.xml": ("s.xml", 2), "a.ply": ("a.ply", 6), "a.gltf": ("a.gltf", 2),
                 "b.gltf": ("b.gltf", None), "e.obj": ("e.obj", None), "a.pbrt": ("a.pbrt", 2)}
        cases.update({f"no.{ending}": (f"no.{ending}", None) for ending in ("xml", "ply", "obj", "gltf", "glb", "pbrt")})
        for name, (file, line) in cases.items():
            with self.subTest(name), self.assertRaises(ptexp.Error) as raised, warnings.catch_warnings():
                warnings.simplefilter("ignore")
                ptexp.load(folder / name)
            self.assertEqual((raised.exception.file, raised.exception.line), (str(folder / file), line), str(raised.exception))
        for use, file in ((lambda: ptexp.read_image(folder / "no.exr"), folder / "no.exr"),
                          (lambda: ptexp.write_image("/no/folder/a.exr", np.zeros((1, 1, 3))), "/no/folder/a.exr"),
                          (lambda: ptexp.read_image(folder / "a.ply"), folder / "a.ply")):
            with self.assertRaises(ptexp.Error) as raised:
                use()
            self.assertEqual((raised.exception.file, raised.exception.line), (str(file), None), str(raised.exception))

    def test_of_none(self):
        for use in (lambda: ptexp.render("cornell", **SMALL, mode="fast"), lambda: ptexp.load("nosuch"),
                    lambda: ptexp.Scene.from_dict({"type": "scene", "a": {"type": "spher"}}),
                    lambda: ptexp.trace(([[0, 0, 0]], [[0, 0, 1]]), np.ones((1, 6)), device="cpu")):
            with self.assertRaises(ptexp.Error) as raised:
                use()
            self.assertEqual((raised.exception.file, raised.exception.line), (None, None), str(raised.exception))


class Texts(TestCase):
    def test_a_text_is_a_file(self):
        path = self.write("room.xml", room())
        self.assert_same_bits(ptexp.load_string(room()).render(device="cpu"), ptexp.render(path, device="cpu"))
        varied = room().replace('"width" value="40"', '"width" value="$n"')
        self.assertEqual(ptexp.load_string(varied, define={"n": 16}, seed=3).defaults["width"], 16)
        for text, line, message in (("<scene>\n<shape>\n</scene>", 3, "mismatch"), (varied, None, r"\$n is not defined"),
                                    ('<scene version="3.0.0">\n<shape type="cube" id="a"/>\n<ref id="b"/></scene>', 3, "'b'"),
                                    ("", 1, "expected a scene in XML")):
            with self.assertRaisesRegex(ptexp.Error, message) as raised:
                ptexp.load_string(text)
            self.assertEqual(raised.exception.file, "<string>")
            if line:
                self.assertEqual(raised.exception.line, line)
        with self.assertWarnsRegex(ptexp.SceneWarning, "<string>:1: shape 'hair'"):
            ptexp.load_string('<scene version="3.0.0"><shape type="hair"/></scene>')
        with self.assertRaisesRegex(ptexp.Error, "hair"):
            ptexp.load_string('<scene version="3.0.0"><shape type="hair"/></scene>', strict=True)


class Dictionaries(TestCase):
    """Errors have their place; tests/python/test_python_mitsuba.py compares images."""

    def test_places(self):
        wrong = object()
        cases = (({"type": "spher"}, r"scene\['a'\]: type 'spher' is not known; did you mean 'sphere'\?"),
                 ({"radius": 1}, r"scene\['a'\]: a dictionary without 'type'"),
                 ({"type": "sphere", "radius": wrong}, r"scene\['a'\]\['radius'\]: object .*; expected a number"),
                 ({"type": "sphere", "radius": "big"}, r"scene\['a'\]\['radius'\]: radius is 'big'; expected a number"),
                 ({"type": "sphere", "center": [1, 2]}, r"scene\['a'\]\['center'\]: 2 numbers; expected"),
                 ({"type": "sphere", "center": [1, [2, "x"]]}, r"scene\['a'\]\['center'\]: str 'x'; expected"),
                 ({"type": "sphere", 3: 1}, r"scene\['a'\]\[3\]: the key is no text"),
                 ({"type": "cube", "bsdf": {"type": "ref", "id": "nobody"}}, r"scene\['a'\]\['bsdf'\]: there is no object with the id 'nobody'"),
                 ({"type": "cube", "to_world": np.zeros((4, 4))}, r"scene\['a'\]\['to_world'\]: <matrix> is not affine"),
                 ({"type": "envmap"}, r"scene\['a'\]: emitter 'envmap' has no filename"),
                 ({"type": "envmap", "data": np.zeros((2, 2, 5))}, r"scene\['a'\]\['data'\]: an array \(2, 2, 5\)"),
                 ({"type": "envmap", "data": np.full((2, 2, 3), np.nan)}, r"scene\['a'\]\['data'\]: a value that is not finite"),
                 ({"type": "heterogeneous", "sigma_t": {"type": "gridvolume", "data": -np.ones((2, 2, 2))}},
                  r"scene\['a'\]\['sigma_t'\]\['data'\]: a value that is not finite or below 0"),
                 ({"type": "heterogeneous", "sigma_t": {"type": "gridvolume", "data": np.ones((2, 2))}},
                  r"scene\['a'\]\['sigma_t'\]\['data'\]: an array \(2, 2\)"))
        for part, message in cases:
            with self.subTest(part), self.assertRaisesRegex(ptexp.Error, message), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                ptexp.Scene.from_dict({"type": "scene", "a": part})
        loop = {"type": "twosided"}
        loop["bsdf"] = loop
        with self.assertRaisesRegex(ptexp.Error, "nested deeper than 64"):
            ptexp.Scene.from_dict({"type": "scene", "a": loop})

    def test_the_default_light(self):
        dark = {"type": "scene", "a": {"type": "sphere"}}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            self.assertGreater(ptexp.Scene.from_dict(dark).render(**SMALL).array.max(), 0)
            self.assertEqual(ptexp.Scene.from_dict(dark, default_lighting="off").render(**SMALL).array.max(), 0)

    def test_shared_pictures_are_one(self):
        picture = {"type": "bitmap", "data": np.ones((2, 2, 3), np.uint8), "id": "p"}
        bsdf = {"type": "diffuse", "reflectance": {"type": "ref", "id": "p"}}
        scene = ptexp.Scene.from_dict({"type": "scene", "p": picture, "l": {"type": "constant"},
                                       **{str(i): {"type": "sphere", "center": [i, 0, 0], "bsdf": dict(bsdf)} for i in range(3)}})
        scene.render(**SMALL)

    def test_folders_and_no_numpy_numbers(self):
        self.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        ptexp.Scene.from_dict({"type": "scene", "r": {"type": "resources", "path": str(self.folder)}, "l": {"type": "constant"},
                               "a": {"type": "obj", "filename": "a.obj", "face_normals": np.bool_(True)}}, strict=True)


if __name__ == "__main__":
    unittest.main()
