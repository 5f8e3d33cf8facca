"""The scene of docs/tutorial.md is one of Mitsuba's: it loads there without a warning, renders, and
gives the picture that ptexp gives.

PTEXP names the program; skips without the Python package `mitsuba`.
"""
import os
import re
import subprocess
import tempfile
import textwrap
import unittest
from pathlib import Path

from mitsuba_package import mi, np

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("PTEXP", str(ROOT / "build" / "release" / "src" / "ptexp"))
WIDTH, HEIGHT, SPP, CELL = 64, 36, 256, 4


@unittest.skipIf(mi is None, "the Python package mitsuba is not installed")
class Tutorial(unittest.TestCase):
    def test_both_programs_render_its_scene_alike(self):
        page = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")
        scene, = re.findall(r"^    <scene .*?^    </scene>\n", page, re.M | re.S)
        with tempfile.TemporaryDirectory() as folder:
            file, image = Path(folder, "balls.xml"), Path(folder, "balls.exr")
            file.write_text(textwrap.dedent(scene).replace('"320"', f'"{WIDTH}"').replace(
                '"180"', f'"{HEIGHT}"'), encoding="utf-8")
            theirs = np.array(mi.render(mi.load_file(str(file)), spp=SPP))
            done = subprocess.run([PROGRAM, "--scene", file, "--spp", str(SPP), "--device", "cpu",
                                   "--output", image], capture_output=True, text=True, check=True)
            ours = np.array(mi.Bitmap(str(image)))
        self.assertNotIn("warning", (done.stdout + done.stderr).lower())
        self.assertEqual(ours.shape, (HEIGHT, WIDTH, 3))
        self.assertEqual(theirs.shape, ours.shape)
        cells = [picture.reshape(HEIGHT // CELL, CELL, WIDTH // CELL, CELL, 3).mean((1, 3))
                 for picture in (ours, theirs)]
        self.assertLess(abs(cells[0].mean() / cells[1].mean() - 1), 0.02)
        # A cell has 4,096 samples; those below the glass ball are of caustics, the noisiest.
        apart = abs(cells[0] - cells[1]) / (cells[1] + 0.05)
        self.assertLess(np.quantile(apart, 0.9), 0.05)
        self.assertLess(np.median(apart), 0.02)


if __name__ == "__main__":
    unittest.main()
