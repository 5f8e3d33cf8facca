"""A room far from the origin gets the same light whether lamps are asked or found by chance.

Skips without the Python package `mitsuba`, which reads the images. PTEXP names the program,
PTEXP_SHARED the folder of scenes.
"""
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

from mitsuba_package import mi, np

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("PTEXP", str(ROOT / "build" / "dev" / "src" / "ptexp"))
SHARED = Path(os.environ.get("PTEXP_SHARED", ROOT.parent / "shared"))


def our_image(path, spp, seed=1, *options):
    image = path.parent / "image.exr"
    subprocess.run([PROGRAM, "--scene", path, "--device", "cpu", "--mode", "megakernel", "--spp",
                    str(spp), "--seed", str(seed), "-q", "-o", image, *options], check=True,
                   stderr=subprocess.DEVNULL)
    return np.array(mi.Bitmap(str(image)))[:, :, :3]


def mean_and_error(images):
    """Mean of all pixels of independent images, and its standard error."""
    means = np.array([image.mean() for image in images])
    return means.mean(), means.std(ddof=1) / np.sqrt(len(means))


@unittest.skipIf(mi is None, "needs the Python package mitsuba")
class Lamps(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_a_room_far_from_the_origin(self):
        path = SHARED / "mitsuba" / "15d_box_far.xml"
        if not path.exists():
            self.skipTest(f"{path} is not there")
        copy = self.folder / "scene.xml"
        copy.write_text(path.read_text().replace("assets/", str(path.parent / "assets") + "/"))
        size = ("--width", "60", "--height", "60")
        ways = [mean_and_error([our_image(copy, 64, seed, "--nee", nee, *size)
                                for seed in range(1, 9)]) for nee in ("on", "off")]
        self.assertLess(abs(ways[0][0] - ways[1][0]),
                        0.002 * ways[1][0] + 4 * np.hypot(ways[0][1], ways[1][1]), ways)


if __name__ == "__main__":
    unittest.main()
