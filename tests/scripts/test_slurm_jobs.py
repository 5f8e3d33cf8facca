"""scripts/slurm_test, on a Slurm of its own where there is one, with a stand-in for ptexp: that the
jobs of examples/slurm do what they say. Where there is none the script must say so.
"""
import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SLURM_TEST = ROOT / "scripts" / "slurm_test"
FAKE = Path(__file__).with_name("fake_jobs_ptexp.sh")
SKIPPED = 77
PATH = f"{os.environ['PATH']}:/usr/sbin:/sbin"
PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch")


def slurm_test(*arguments, **environment):
    return subprocess.run([SLURM_TEST, *arguments], capture_output=True, text=True, check=False,
                          timeout=600, env={**os.environ, "PTEXP": str(FAKE), **environment})


class SlurmJobs(unittest.TestCase):
    def test_without_slurm(self):
        with tempfile.TemporaryDirectory(prefix="ptexp slurm ") as folder:
            for name in ("bash", "env", "dirname", "awk"):
                Path(folder, name).symlink_to(shutil.which(name))
            done = slurm_test(PATH=folder)
        self.assertEqual(done.returncode, SKIPPED, done.stdout + done.stderr)
        self.assertIn("skipped: no" if os.geteuid() == 0 else "skipped: not root", done.stdout)

    def test_the_jobs(self):
        if os.geteuid() != 0 or not all(shutil.which(name, path=PATH) for name in PROGRAMS):
            self.skipTest("no Slurm, or not root")
        done = slurm_test()
        if done.returncode == SKIPPED:
            self.skipTest(done.stdout)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"(?m)^\d+ passed, 0 failed$")

    def test_unknown_options(self):
        done = slurm_test("--unknown")
        self.assertEqual((done.returncode, len(done.stderr.splitlines())), (1, 1))


if __name__ == "__main__":
    unittest.main()
