"""scripts/compare_gpus sees images that differ, and that are missing.

The environment variable PTEXP names the executable (build/release/src/ptexp).
"""
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PTEXP = Path(os.environ.get("PTEXP", ROOT / "build" / "release" / "src" / "ptexp")).resolve()


def compare(folder, *more):
    return subprocess.run(
        [sys.executable, ROOT / "scripts" / "compare_gpus", str(folder), "--device", "cpu",
         "--size", "12", *more], env={**os.environ, "PTEXP": str(PTEXP)}, capture_output=True,
        text=True, check=False, timeout=600)


class CompareGpus(unittest.TestCase):
    def test_folders_of_devices(self):
        with tempfile.TemporaryDirectory() as folder:
            first = compare(folder)
            self.assertEqual(first.returncode, 0, first.stderr)
            self.assertIn("no other device yet", first.stdout)
            (mine,) = Path(folder).iterdir()
            other = Path(folder) / "another"
            shutil.copytree(mine, other)
            same = compare(folder)
            self.assertEqual(same.returncode, 0, same.stdout)
            self.assertIn("another: the same bits", same.stdout)
            # The other device's wavefront of one scene is that of another scene.
            shutil.copy(mine / "spheres-wavefront.exr", other / "cornell-wavefront.exr")
            (other / "cornell-chains.exr").unlink()
            different = compare(folder)
            self.assertEqual(different.returncode, 1)
            self.assertIn("DIFFERENT: cornell-wavefront.exr cornell-chains.exr", different.stdout)

    def test_what_cannot_be_rendered(self):
        with tempfile.TemporaryDirectory() as folder:
            failed = compare(folder, "--scenes", f"{folder}/absent.xml")
            self.assertEqual(failed.returncode, 2)
            self.assertIn("absent.xml", failed.stderr)


if __name__ == "__main__":
    unittest.main()
