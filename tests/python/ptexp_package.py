"""What the tests of the Python module share.

They run where the module is: PTEXP_PYTHON_PATH is the folder of a package `ptexp`, unless it is
installed. PTEXP is the program of the same build, whose bits the module has to give.
"""
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
if os.environ.get("PTEXP_PYTHON_PATH"):
    sys.path.insert(0, os.environ["PTEXP_PYTHON_PATH"])
PTEXP = os.environ.get("PTEXP", "")

try:
    import numpy as np
    import ptexp
except ImportError as error:
    if os.environ.get("PTEXP_NEEDS_PYTHON"):
        raise
    raise unittest.SkipTest(f"needs the module and numpy: {error}")


class TestCase(unittest.TestCase):
    """Has a folder, and compares bits."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def program(self, *arguments):
        """The image that the program renders."""
        if not PTEXP:
            self.skipTest("PTEXP names no program to compare with")
        path = self.folder / "program.exr"
        subprocess.run([PTEXP, *map(str, arguments), "--quiet", "--output", path], check=True, timeout=300)
        return ptexp.read_image(path)

    def assert_same_bits(self, a, b):
        a, b = np.asarray(a), np.asarray(b)
        self.assertEqual(a.shape, b.shape)
        different = int((a.view(np.uint32) != b.view(np.uint32)).sum())
        self.assertEqual(different, 0, f"{different} values differ in bits")

    def assert_other_image(self, a, b):
        self.assertFalse(np.array_equal(np.asarray(a), np.asarray(b)), "nothing has changed")

    def write(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path


ROOM = """<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="6"/></integrator>
  <sensor type="perspective">
    <float name="fov" value="$fov"/><string name="fov_axis" value="y"/>
    <transform name="to_world"><lookat origin="$x, 1, 4" target="0, 0.5, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="40"/><integer name="height" value="32"/>
      <rfilter type="box"/></film>
    <sampler type="independent"><integer name="sample_count" value="8"/></sampler>
  </sensor>
  <bsdf type="diffuse" id="red"><rgb name="reflectance" value="$red, 0.1, 0.1"/></bsdf>
  <bsdf type="roughconductor" id="metal"><float name="alpha" value="$alpha"/></bsdf>
  <bsdf type="roughplastic" id="lacquer"><rgb name="diffuse_reflectance" value="0.1, 0.3, 0.7"/>
    <float name="alpha" value="$lacquer"/><float name="int_ior" value="$eta"/>
    <float name="ext_ior" value="1"/></bsdf>
  <shape type="rectangle"><ref id="red"/>
    <transform name="to_world"><rotate x="1" angle="-90"/><scale value="3"/></transform></shape>
  <shape type="shapegroup" id="group"><shape type="cube"><ref id="metal"/>
    <transform name="to_world"><scale value="0.4"/></transform></shape></shape>
  <shape type="instance"><ref id="group"/>
    <transform name="to_world"><translate x="$cube" y="0.4"/></transform></shape>
  <shape type="instance"><ref id="group"/>
    <transform name="to_world"><translate x="1" y="1.2"/></transform></shape>
  <shape type="cube"><ref id="lacquer"/>
    <transform name="to_world"><scale value="0.3"/><translate x="1.4" y="0.3" z="1"/></transform></shape>
  <shape type="rectangle" id="lamp">
    <transform name="to_world"><rotate x="1" angle="90"/><translate y="3"/></transform>
    <emitter type="area"><rgb name="radiance" value="$lamp, $lamp, $lamp"/></emitter></shape>
  <emitter type="point" id="bulb"><point name="position" x="-2" y="2" z="1"/>
    <rgb name="intensity" value="$bulb, 1, 1"/></emitter>
</scene>
"""

ROOM_VALUES = {"fov": 40, "x": 0.5, "red": 0.8, "alpha": 0.2, "lacquer": 0.1, "eta": 1.5, "cube": -1, "lamp": 5, "bulb": 2}


def room(**values):
    """A Mitsuba scene: camera, materials, an emitting rectangle, a point light, two instances."""
    everything = {**ROOM_VALUES, **values}
    return re.sub(r"\$([a-z]+)", lambda match: repr(everything[match[1]]), ROOM)
