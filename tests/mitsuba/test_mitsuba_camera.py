"""The field of view of a Mitsuba file in images of other shapes than its own.

A ball before a white sky is rendered by Mitsuba 3 and by `ptexp --width W --height H`: its area in
pixels must agree. PTEXP names the program; skips without the Python package `mitsuba`.
"""
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

from mitsuba_package import mi, np

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("PTEXP", str(ROOT / "build" / "dev" / "src" / "ptexp"))
SIZES = [(160, 90), (90, 90), (90, 160)]
SPP = 16


def scene(width, height, view):
    return f"""<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="2"/></integrator>
  <sensor type="perspective">{view}
    <transform name="to_world"><lookat origin="0,0,5" target="0,0,0" up="0,1,0"/></transform>
    <film type="hdrfilm"><integer name="width" value="{width}"/>
      <integer name="height" value="{height}"/><rfilter type="box"/></film></sensor>
  <shape type="sphere"><bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf></shape>
  <emitter type="constant"/>
</scene>"""


def fov(axis):
    return f'<float name="fov" value="70"/><string name="fov_axis" value="{axis}"/>'


@unittest.skipIf(mi is None, "the Python package mitsuba is not installed")
class FieldOfView(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def dark_pixels(self, image):
        return float(np.sum(1 - np.array(image)[:, :, 0]))

    def mitsuba(self, width, height, view):
        loaded = mi.load_string(scene(width, height, view))
        return self.dark_pixels(mi.render(loaded, spp=SPP))

    def ptexp(self, width, height, view, *options):
        folder = Path(self.folder.name)
        (folder / "scene.xml").write_text(scene(*SIZES[0], view))
        subprocess.run([PROGRAM, "--quiet", "--scene", str(folder / "scene.xml"), "--spp", str(SPP),
                        "--width", str(width), "--height", str(height), "--device", "cpu",
                        "--output", str(folder / "a.exr"), *options], check=True)
        return self.dark_pixels(mi.Bitmap(str(folder / "a.exr")))

    def check(self, view):
        for width, height in SIZES:
            with self.subTest(view=view, width=width, height=height):
                expected = self.mitsuba(width, height, view)
                # Noise: 16 samples of some 100 pixels at the edge, sigma below 0.125 a pixel.
                self.assertAlmostEqual(self.ptexp(width, height, view), expected,
                                       delta=5 * 0.125 * np.sqrt(2 * 200))

    def test_the_axis_of_the_file_stays_fixed(self):
        for axis in ["x", "y", "diagonal", "smaller", "larger"]:
            self.check(fov(axis))

    def test_focal_lengths_fix_the_diagonal(self):
        self.check('<string name="focal_length" value="35mm"/>')

    def test_the_option_fov_is_vertical(self):
        for width, height in SIZES:
            area = self.ptexp(width, height, fov("x"), "--fov", "50")
            self.assertAlmostEqual(area, self.mitsuba(width, height, fov("y").replace("70", "50")),
                                   delta=5 * 0.125 * np.sqrt(2 * 200))


if __name__ == "__main__":
    unittest.main()
