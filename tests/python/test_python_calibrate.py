"""ptexp.calibrate stores what later renders use."""
import json
import os
import tempfile
import unittest
from unittest import mock

import ptexp


class Calibrate(unittest.TestCase):
    def test_later_plans_use_it(self):
        with tempfile.TemporaryDirectory() as folder, mock.patch.dict(os.environ, XDG_CACHE_HOME=folder):
            found = ptexp.calibrate(device="cpu", threads=2)
            self.assertTrue(found.file.startswith(folder))
            self.assertIn("measured in", str(found))
            self.assertGreater(len(found.constants) + len(found.kept), 5)
            with open(found.file, encoding="utf-8") as file:
                stored = json.load(file)
            self.assertEqual(stored["constants"], found.constants)
            stored["constants"]["scan_primitives"] = 20
            with open(found.file, "w", encoding="utf-8") as file:
                json.dump(stored, file)

            def reason(**options):
                return {line["option"]: line["reason"] for line in
                        ptexp.explain("spheres", device="cpu", threads=2, **options)}["accel"]
            self.assertTrue(reason().endswith("(measured here)"), reason())
            self.assertTrue(reason(calibration="none").endswith("(from an H200)"))

    def test_what_it_refuses(self):
        with self.assertRaises(ptexp.OptionError):
            ptexp.calibrate(device="cuda:77")
        with mock.patch.dict(os.environ, clear=True), self.assertRaisesRegex(ptexp.Error, "no cache folder"):
            ptexp.calibrate(device="cpu")


if __name__ == "__main__":
    unittest.main()
