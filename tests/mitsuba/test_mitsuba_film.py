"""What the film does, against Mitsuba 3: AOVs; crop windows of its files.

PTEXP names the program; skips without the Python package `mitsuba`.
"""
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

from mitsuba_package import mi, np

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("PTEXP", str(ROOT / "build" / "dev" / "src" / "ptexp"))
WIDTH, HEIGHT = 32, 24
SEEDS = 8  # renders of each program, whose spread tells its variance

SHAPES = """
  <shape type="rectangle"><transform name="to_world"><scale value="3"/>
      <rotate x="1" angle="-60"/><translate y="-1"/></transform>
    <bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.2,0.5,0.7"/></bsdf>
    </bsdf></shape>
  <shape type="sphere"><point name="center" x="-0.9" y="0.3" z="0.5"/>
    <float name="radius" value="0.8"/>
    <bsdf type="diffuse"><rgb name="reflectance" value="0.6,0.3,0.1"/></bsdf></shape>
  <shape type="cube"><transform name="to_world"><scale value="0.5"/><rotate y="1" angle="30"/>
      <translate x="1" y="0.2" z="0.6"/></transform>
    <bsdf type="diffuse"><rgb name="reflectance" value="0.4"/></bsdf></shape>"""


def scene(integrator, film):
    return f"""<scene version="3.0.0">{integrator}
  <sensor type="perspective"><float name="fov" value="45"/>
    <float name="near_clip" value="1e-4"/>
    <transform name="to_world"><lookat origin="0.3,1,5" target="0,0,0" up="0,1,0"/></transform>
    <film type="hdrfilm"><integer name="width" value="{WIDTH}"/>
      <integer name="height" value="{HEIGHT}"/>
      <string name="pixel_format" value="rgb"/>{film}</film></sensor>{SHAPES}
  <emitter type="constant"><float name="radiance" value="0.8"/></emitter>
</scene>"""


# Mitsuba divides by the sum of the weights within the image: a filter differs near its border.
INNER = np.s_[3:-3, 3:-3] if np else None
PATH = '<integrator type="path"><integer name="max_depth" value="2"/></integrator>'
AOVS = {"albedo": ("albedo", "RGB"), "sh_normal": ("shading_normal", "XYZ"),
        "geo_normal": ("normal", "XYZ"), "depth": ("depth", "Z"), "position": ("position", "XYZ")}


@unittest.skipIf(mi is None, "the Python package mitsuba is not installed")
class FilmAgainstMitsuba(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def render(self, text, *options):
        """ptexp's image as a bitmap."""
        folder = Path(self.folder.name)
        (folder / "scene.xml").write_text(text)
        subprocess.run([PROGRAM, "--quiet", "--scene", str(folder / "scene.xml"), "--device", "cpu",
                        "--output", str(folder / "a.exr"), *options], check=True)
        return mi.Bitmap(str(folder / "a.exr"))

    @staticmethod
    def statistics(images):
        """Mean, and the variance of it."""
        images = np.array(images)
        return images.mean(axis=0), images.var(axis=0, ddof=1) / SEEDS

    def reference(self, text, spp=64):
        loaded = mi.load_string(text)
        return self.statistics([np.array(mi.render(loaded, spp=spp, seed=s)) for s in range(SEEDS)])

    def seeds(self, text, *options, spp=64):
        return self.statistics([np.array(self.render(text, "--spp", str(spp), "--seed", str(s),
                                                     *options)) for s in range(1, SEEDS + 1)])

    def check(self, found, expected, floor=2e-3, inner=np.s_[:, :] if np else None):
        """Two pairs of mean and variance. Of each pixel z is at most 6 beyond a floor, but for a
        few of which the variance, of SEEDS values, came out too small."""
        difference = (found[0] - expected[0])[inner]
        variance = (found[1] + expected[1])[inner]
        z = np.abs(difference) / np.sqrt(variance + floor ** 2)
        self.assertLess(np.mean(z > 6), 0.005, f"worst: {np.max(z)}")
        # Signed, over all pixels: a shift or a wrong width would not hide in the noise.
        error = np.mean(difference, axis=(0, 1))
        spread = np.sqrt(np.mean(variance, axis=(0, 1)) / difference[..., 0].size)
        self.assertTrue(np.all(np.abs(error) < 6 * spread + 0.2 * floor), (error, spread))

    def test_crop(self):
        crop = "".join(f'<integer name="crop_{name}" value="{value}"/>' for name, value in
                       [("offset_x", 5), ("offset_y", 3), ("width", 20), ("height", 15)])
        box = '<rfilter type="box"/>'
        text = scene(PATH, crop + box)
        cropped = np.array(self.render(text, "--spp", "8"))
        self.assertEqual(cropped.shape, (15, 20, 3))
        whole = np.array(self.render(scene(PATH, box), "--spp", "8"))
        self.assertTrue(np.array_equal(cropped, whole[3:18, 5:25]))
        by_option = np.array(self.render(text, "--spp", "8", "--crop", "1,2,30,23"))
        self.assertTrue(np.array_equal(by_option, whole[2:23, 1:30]))

    def channels(self, text, names):
        """What ptexp's layers hold, in the order of AOVS."""
        images = []
        for seed in range(1, SEEDS + 1):
            bitmap = self.render(text, "--spp", "64", "--seed", str(seed), "--aov", ",".join(names))
            values = dict(zip([field.name for field in bitmap.struct_()],
                              np.moveaxis(np.array(bitmap), 2, 0)))
            images.append(np.stack([values[f"{name}.{c}"] for name, letters in AOVS.values()
                                    for c in letters], axis=-1))
        return self.statistics(images)

    def check_aovs(self, film):
        names = ",".join(f"a{i}:{name}" for i, name in enumerate(AOVS))
        integrator = (f'<integrator type="aov"><string name="aovs" value="{names}"/>{PATH}'
                      '</integrator>')
        mean, variance = self.reference(scene(integrator, film))
        found = self.channels(scene(PATH, film), [name for name, _ in AOVS.values()])
        first = 0
        for name, letters in AOVS.values():
            part = np.s_[..., first:first + len(letters)]
            behind = np.s_[..., 3 + first:3 + first + len(letters)]
            with self.subTest(aov=name, film=film):
                self.check((found[0][part], found[1][part]), (mean[behind], variance[behind]),
                           inner=INNER)
            first += len(letters)

    def test_aovs(self):
        self.check_aovs('<rfilter type="box"/>')

    def test_aovs_are_filtered(self):
        self.check_aovs('<rfilter type="mitchell"/>')


if __name__ == "__main__":
    unittest.main()
