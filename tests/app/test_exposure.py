"""The exposure of PNG and PPM, from the command line: PTEXP names the program."""
import base64
import json
import os
import struct
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("PTEXP", str(ROOT / "build" / "dev" / "src" / "ptexp"))


def gltf(lux):
    """A grey square without highlights that fills the image, and a sun of so many lux, or none."""
    corners = struct.pack("<12f", -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0)
    data = corners + struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    root = {"asset": {"version": "2.0"}, "scenes": [{"nodes": [0, 1]}],
            "nodes": [{"mesh": 0}, {}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1,
                                        "material": 0}]}],
            "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0,
                                                    "baseColorFactor": [0.5, 0.5, 0.5, 1]},
                           "extensions": {"KHR_materials_specular": {"specularFactor": 0}}}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
                           "min": [-1, -1, 0], "max": [1, 1, 0]},
                          {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
            "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48},
                            {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
            "buffers": [{"byteLength": 60, "uri": "data:application/octet-stream;base64," +
                         base64.b64encode(data).decode()}]}
    if lux:
        root["extensions"] = {"KHR_lights_punctual": {
            "lights": [{"type": "directional", "intensity": lux}]}}
        root["nodes"][1] = {"extensions": {"KHR_lights_punctual": {"light": 0}}}
    return json.dumps(root)


class Exposure(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def render(self, lux, output, *options):
        """What is said, the stops used, the file's bytes."""
        (self.folder / "a.gltf").write_text(gltf(lux))
        run = subprocess.run(
            [PROGRAM, "--scene", "a.gltf", "--width", "16", "--height", "16", "--spp", "4",
             "--look-from", "0,0,1", "--look-at", "0,0,0", "--device", "cpu", "--output", output,
             "--stats", "a.json", *options],
            cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stderr)
        stats = json.loads((self.folder / "a.json").read_text())
        return run.stdout, stats["used"]["exposure"], (self.folder / output).read_bytes()

    def middle(self, ppm):
        """The encoded value in the middle of 16 x 16 pixels."""
        return ppm[-3 * 256:][3 * (8 * 16 + 8)]

    def test_a_sun_in_lux_does_not_burn_a_png(self):
        said, stops, data = self.render(50000, "a.png")
        # Lambert: 50,000 lux on 0.5 is a radiance of 7958; to 0.18: -15.43 stops.
        self.assertAlmostEqual(stops, -15.432, delta=0.01)
        self.assertIn("exposure -15.43 stops, measured", said)
        self.assertIn(b"ptexp.exposure", data)
        ppm = self.render(50000, "a.ppm", "--exposure", "auto")
        self.assertEqual(ppm[1], stops)
        self.assertAlmostEqual(self.middle(ppm[2]), 255 * 0.18 ** 0.5, delta=1)  # gamma 2

    def test_elsewhere_the_exposure_is_what_is_asked_for(self):
        self.assertEqual(self.render(50000, "a.ppm")[1], 0)
        self.assertEqual(self.middle(self.render(50000, "a.ppm")[2]), 255)
        said, stops, _ = self.render(50000, "a.png", "--exposure", "-14.5")
        self.assertEqual(stops, -14.5)
        self.assertNotIn("exposure", said)
        self.assertIsNone(self.render(50000, "a.exr")[1])

    def test_a_file_without_light_is_measured(self):
        said, stops, _ = self.render(0, "a.png")
        self.assertIn("stops, measured", said)
        self.assertNotEqual(stops, 0)

    def test_an_exr_has_no_exposure(self):
        run = subprocess.run([PROGRAM, "--exposure", "auto", "--output", "a.exr"],
                             cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(run.returncode, 2)
        self.assertIn("--exposure auto: applies to .png and .ppm", run.stderr)


if __name__ == "__main__":
    unittest.main()
