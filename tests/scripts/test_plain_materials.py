"""scripts/mitsuba_plain_materials: what becomes of each kind of surface."""
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "mitsuba_plain_materials"
SCENE = """<scene version="3.0.0">
  <bsdf type="twosided" id="floor"><bsdf type="roughplastic"><float name="alpha" value="0.1"/>
    <texture type="bitmap" name="diffuseReflectance"><string name="filename" value="a.jpg"/>
    </texture></bsdf></bsdf>
  <bsdf type="mask" id="leaves"><float name="opacity" value="0.5"/><bsdf type="twosided">
    <bsdf type="diffuse"><rgb name="reflectance" value="0.2"/></bsdf></bsdf></bsdf>
  <bsdf type="principled" id="tiles"><rgb name="base_color" value="0.3"/>
    <float name="metallic" value="0.7"/><float name="roughness" value="0.5"/></bsdf>
  <bsdf type="principled" id="cloth"><rgb name="base_color" value="0.4"/>
    <float name="metallic" value="0.1"/></bsdf>
  <bsdf type="dielectric" id="glass"><float name="int_ior" value="1.5"/></bsdf>
  <shape type="sphere"><bsdf type="roughdiffuse"><rgb name="reflectance" value="0.6"/></bsdf></shape>
</scene>"""
EXPECTED = """<scene version="3.0.0">
  <bsdf type="twosided" id="floor"><bsdf type="diffuse"><texture type="bitmap" name="reflectance">
    <string name="filename" value="a.jpg"/></texture></bsdf></bsdf>
  <bsdf type="twosided" id="leaves"><bsdf type="diffuse"><rgb name="reflectance" value="0.2"/></bsdf>
  </bsdf>
  <bsdf type="roughconductor" id="tiles"><string name="material" value="none"/>
    <float name="alpha" value="0.25"/><rgb name="specular_reflectance" value="0.3"/></bsdf>
  <bsdf type="diffuse" id="cloth"><rgb name="reflectance" value="0.4"/></bsdf>
  <bsdf type="dielectric" id="glass"><float name="int_ior" value="1.5"/></bsdf>
  <shape type="sphere"><bsdf type="diffuse"><rgb name="reflectance" value="0.6"/></bsdf></shape>
</scene>"""


def canonical(text):
    return xml.canonicalize(text, strip_text=True)


class PlainMaterials(unittest.TestCase):
    def test_each_kind(self):
        with tempfile.TemporaryDirectory() as folder:
            before, after = Path(folder, "scene.xml"), Path(folder, "plain.xml")
            before.write_text(SCENE, encoding="utf-8")
            subprocess.run([sys.executable, SCRIPT, before, after], check=True)
            self.assertEqual(canonical(after.read_text(encoding="utf-8")), canonical(EXPECTED))


if __name__ == "__main__":
    unittest.main()
