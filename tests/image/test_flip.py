"""`ptexp compare` finds the FLIP that the package flip-evaluator finds, in rendered images.

PTEXP names the program; skips without the Python package `flip-evaluator`.
"""
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

try:
    import flip_evaluator
except ImportError:
    flip_evaluator = None

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("PTEXP", str(ROOT / "build" / "dev" / "src" / "ptexp"))


@unittest.skipIf(flip_evaluator is None, "the Python package flip-evaluator is not installed")
class FlipOfRenders(unittest.TestCase):
    def check(self, ending, kind):
        with tempfile.TemporaryDirectory() as folder:
            files = [str(Path(folder) / f"{name}.{ending}") for name in "ab"]
            for file, spp in zip(files, ("2", "32")):
                subprocess.run([PROGRAM, "--quiet", "--scene", "cornell", "--device", "cpu",
                                "--width", "64", "--height", "48", "--spp", spp, "-o", file],
                               check=True)
            text = subprocess.run([PROGRAM, "compare", *files, "--tolerance", "1e9",
                                   "--difference", str(Path(folder) / "d.png")],
                                  check=True, capture_output=True, text=True).stdout
            found = float(re.search(rf"^{kind}-FLIP +(\S+)$", text, re.MULTILINE).group(1))
            _, expected, _ = flip_evaluator.evaluate(files[1], files[0], kind)
            self.assertGreater(expected, 0.02)
            self.assertAlmostEqual(found, expected, delta=2e-5)

    def test_radiance(self):
        self.check("exr", "HDR")

    def test_displayed(self):
        self.check("png", "LDR")


if __name__ == "__main__":
    unittest.main()
