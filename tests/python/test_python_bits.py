"""The Python module gives the bits of the program: modes, scenes, options, one scene again and again."""
import contextlib
import io
import json
import subprocess
import unittest

from ptexp_package import PTEXP, ROOT, TestCase, np, ptexp, room

SMALL = {"width": 48, "height": 32, "spp": 4}
WORDS = ["--width", 48, "--height", 32, "--spp", 4]


class Bits(TestCase):
    def test_modes_of_a_built_in_scene(self):
        for name in ("spheres", "cornell"):
            scene = ptexp.load(name, **SMALL)
            for mode in ("serial", "megakernel", "wavefront"):
                with self.subTest(scene=name, mode=mode):
                    expected = self.program("--scene", name, *WORDS, "--mode", mode)
                    self.assert_same_bits(ptexp.render(scene, mode=mode), expected)

    def test_a_file_decides_what_nobody_else_does(self):
        path = self.write("room.xml", room())
        self.assertEqual(ptexp.load(path).defaults, {"width": 40, "height": 32, "spp": 8, "max_depth": 6})
        image = ptexp.render(path)
        self.assertEqual(image.shape, (32, 40, 3))
        self.assertEqual(image.stats["samples_done"], 8)
        self.assertEqual(image.stats["options"]["max_depth"], 6)
        self.assert_same_bits(image, self.program("--scene", path))

    def test_options(self):
        cases = [
            ({"seed": 7, "rr": 3}, ["--seed", 7, "--rr", 3]),
            ({"nee": False}, ["--nee", "off"]),
            ({"mis": "none", "max_depth": 3}, ["--mis", "none", "--max-depth", 3]),
            ({"look_from": (0.1, 1.5, 5), "fov": 55.5}, ["--look-from", "0.1,1.5,5", "--fov", 55.5]),
            ({"crop": (4, 2, 40, 30), "filter": ("gaussian", 0.6)},
             ["--crop", "4,2,40,30", "--filter", "gaussian:0.6"]),
            ({"integrator": "mlt", "chains": 64}, ["--integrator", "mlt", "--chains", 64]),
            ({"accel": "bvh2", "builder": "sah", "sampler": "sobol"},
             ["--accel", "bvh2", "--builder", "sah", "--sampler", "sobol"]),
            ({"aperture": 0.3, "focus_distance": np.float32(3.5)},
             ["--aperture", 0.3, "--focus-distance", 3.5]),
            ({"width": np.int64(31), "height": 17}, ["--width", 31, "--height", 17]),
        ]
        path = self.write("room.xml", room())
        scene = ptexp.load(path)  # one for all: what is kept of one render must not stay in the next
        for options, words in cases:
            with self.subTest(options=options):
                self.assert_same_bits(ptexp.render(scene, **options), self.program("--scene", path, *words))
        self.assert_same_bits(ptexp.render(scene), self.program("--scene", path))

    @unittest.skipIf(not PTEXP, "PTEXP names no program to compare with")
    def test_every_option_has_its_keyword(self):
        help_text = subprocess.run([PTEXP, "--help-all"], capture_output=True, text=True, check=True).stdout
        keywords = {option["keyword"] for option in ptexp.options()}
        for option in ptexp.options():
            self.assertIn(f"--{option['name']}", help_text)
            self.assertIn(f"{option['keyword']} (", ptexp.render.__doc__)
        self.assertTrue({"max_depth", "look_from", "time_limit", "stage_block"} <= keywords)

    def test_layers(self):
        words = ["--aov", "depth,albedo,material,variance"]
        image = ptexp.render("cornell", **SMALL, aov=("depth", "albedo", "material", "variance"))
        self.assertEqual(sorted(image.aovs), ["albedo", "depth", "material", "variance"])
        self.assertEqual(image.aovs["depth"].shape, (32, 48))
        self.assertEqual(image.aovs["albedo"].shape, (32, 48, 3))
        self.assertEqual(image.aovs["material"].dtype, np.uint32)
        self.assert_same_bits(image, self.program("--scene", "cornell", *WORDS, *words))
        # The camera stands in front of the room and sees its back wall through the middle.
        self.assertGreater(float(image.aovs["depth"][16, 24]), 0)
        with self.assertRaises(KeyError):
            image.aovs["shininess"]

    def test_files(self):
        stats, csv = self.folder / "run.json", self.folder / "runs.csv"
        image = ptexp.render("cornell", **SMALL, output=self.folder / "a.exr", stats=stats, csv=csv)
        self.assert_same_bits(ptexp.read_image(self.folder / "a.exr"), image)
        written = json.loads(stats.read_text())
        self.assertEqual(written["counts"], image.stats["counts"])
        self.assertEqual(set(written), set(image.stats))
        self.assertEqual(len(csv.read_text().splitlines()), 2)
        image.save(self.folder / "b.png")
        self.program("--scene", "cornell", *WORDS)
        subprocess.run([PTEXP, "--scene", "cornell", *map(str, WORDS), "-q", "-o", self.folder / "c.png"], check=True)
        self.assert_same_bits(ptexp.read_image(self.folder / "b.png"), ptexp.read_image(self.folder / "c.png"))
        subprocess.run([PTEXP, "verify", self.folder / "a.exr"], check=True)

    def test_what_a_file_knows(self):
        path = self.folder / "a.exr"
        image = ptexp.render("cornell", **SMALL, output=path)
        self.assertEqual(image.metadata["ptexp.samples_done"], "4")
        self.assertEqual(image.metadata["ptexp.option.width"], "48")
        read = ptexp.read_image(path)
        self.assertEqual(read.metadata, image.metadata)
        self.assertEqual((read.width, read.height, read.shape, read.stats), (48, 32, (32, 48, 3), {}))

    @unittest.skipIf(not PTEXP, "PTEXP names no program to compare with")
    def test_exposures(self):
        image = ptexp.render("cornell", **SMALL, exposure=1.5)
        for given, word in ((None, "1.5"), (2, "2"), (0.0, "0"), (np.float32(-1.25), "-1.25"), ("auto", "auto")):
            with self.subTest(given):
                path = self.folder / "program.png"
                subprocess.run([PTEXP, "--scene", "cornell", *map(str, WORDS), "--exposure", word, "-q", "-o", path],
                               check=True)
                image.save(self.folder / "a.png", exposure=given)
                self.assert_same_bits(ptexp.read_image(self.folder / "a.png"), ptexp.read_image(path))
        ptexp.render("cornell", **SMALL, exposure="auto", output=self.folder / "a.png")
        self.assert_same_bits(ptexp.read_image(self.folder / "a.png"), ptexp.read_image(path))
        with self.assertRaisesRegex(ptexp.OptionError, r"applies to \.png and \.ppm"):
            ptexp.render("cornell", **SMALL, exposure=1, output=self.folder / "a.exr")
        image.save(self.folder / "a.ppm", exposure=-2)
        self.assertEqual(image.stats["used"]["exposure"], -2)  # of the file that was written last

    def test_a_render_overrides_what_its_scene_was_loaded_with(self):
        scene = ptexp.load("cornell", **SMALL, seed=3, max_depth=2)
        expected = self.program("--scene", "cornell", *WORDS, "--seed", 5, "--max-depth", 2)
        self.assert_same_bits(ptexp.render(scene, seed=5, rr=None), expected)
        other = self.program("--scene", "cornell", *WORDS, "--seed", 3, "--max-depth", 2)
        self.assert_same_bits(ptexp.render(scene), other)

    def test_the_table_is_printed_where_it_is_asked_for(self):
        for options, is_printed in (({}, False), ({"quiet": True}, False), ({"quiet": False}, True)):
            with contextlib.redirect_stdout(io.StringIO()) as printed:
                ptexp.render("cornell", **SMALL, **options)
            self.assertEqual("48x32, 4 samples per pixel" in printed.getvalue(), is_printed)
            self.assertEqual(bool(printed.getvalue()), is_printed)

    def test_the_table_of_options(self):
        table = {option["keyword"]: option for option in ptexp.options()}
        self.assertEqual(table["max_depth"]["default"], "50")
        self.assertEqual(table["nee"]["default"], "on")
        self.assertEqual((table["max_depth"]["name"], table["seed"]["default"]), ("max-depth", "1"))

    def test_the_plan(self):
        for choice in ptexp.explain("cornell", mode="wavefront"):
            self.assertTrue(choice["option"] and choice["value"], choice)
            self.assertNotEqual(choice["reason"], choice["value"])
        path = self.folder / "none.exr"
        self.assertTrue(ptexp.explain("cornell", output=path, quiet=False))
        self.assertFalse(path.exists())
        plan = ptexp.explain("cornell", mode="wavefront")
        self.assertIn("accel", [choice["option"] for choice in plan])
        self.assertTrue(all(choice["reason"] for choice in plan))


if __name__ == "__main__":
    unittest.main()
