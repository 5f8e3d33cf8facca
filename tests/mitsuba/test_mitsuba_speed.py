"""scripts/mitsuba_speed measures both programs and writes its table.

Skips without the Python package `mitsuba`. PTEXP names the program.
"""
import csv
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from mitsuba_package import mi

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("PTEXP", str(ROOT / "build" / "release" / "src" / "ptexp"))
SCENE = """<scene version="3.0.0">
  <integrator type="path"/>
  <sensor type="perspective">
    <float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0, 1, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="9"/></film>
    <sampler type="independent"/>
  </sensor>
  <shape type="cube"><bsdf type="diffuse"/></shape>
  <emitter type="constant"/>
</scene>
"""


@unittest.skipIf(mi is None, "needs the Python package mitsuba")
class Speed(unittest.TestCase):
    def test_table(self):
        with tempfile.TemporaryDirectory() as folder:
            scene, table = Path(folder, "box", "scene.xml"), Path(folder, "speed.csv")
            scene.parent.mkdir()
            scene.write_text(SCENE, encoding="utf-8")
            run = subprocess.run(
                [sys.executable, str(ROOT / "scripts" / "mitsuba_speed"), "--spp", "4", "--size",
                 "16", "--rounds", "2", "--threads", "1", "--variants", "scalar_rgb", "--output",
                 str(table), str(scene)], env={**os.environ, "PTEXP": PROGRAM},
                capture_output=True, text=True, check=False, timeout=300)
            self.assertEqual(run.returncode, 0, run.stderr)
            with open(table, encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
        self.assertEqual([(row["program"], row["variant"]) for row in rows],
                         [("ptexp", "wavefront"), ("mitsuba", "scalar_rgb")])
        for row in rows:
            self.assertEqual((row["scene"], row["rounds"], row["spp"]), ("box", "2", "4"))
            seconds = float(row["seconds_median"])
            self.assertLessEqual(float(row["seconds_min"]), seconds)
            self.assertGreaterEqual(float(row["seconds_max"]), seconds)
        self.assertNotEqual(rows[0]["commit"], rows[1]["commit"])
        self.assertEqual(rows[1]["commit"], mi.__version__)


if __name__ == "__main__":
    unittest.main()
