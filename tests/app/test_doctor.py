"""Runs `ptexp doctor` where it is: whatever is missing, it says so and does not fail otherwise.

The environment variable PTEXP names the executable (build/release/src/ptexp).
"""
import json
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PTEXP = Path(os.environ.get("PTEXP", ROOT / "build" / "release" / "src" / "ptexp")).resolve()


def doctor(*arguments, **popen):
    return subprocess.run([PTEXP, "doctor", *arguments], capture_output=True, text=True,
                          check=False, timeout=120, **popen)


class Doctor(unittest.TestCase):
    def test_every_line_has_its_status_and_every_fault_its_remedy(self):
        run = doctor()
        self.assertIn(run.returncode, (0, 1), run.stderr)
        self.assertEqual(run.stderr, "")
        lines = run.stdout.splitlines()
        for line, following in zip(lines, [*lines[1:], ""]):
            self.assertRegex(line, r"^(ok|warning|missing) +\S|^ +-> \S")
            if line.startswith(("warning", "missing")):
                self.assertRegex(following, r"^ +-> ")
        self.assertEqual(run.returncode, int(any(line.startswith("missing") for line in lines)))

    def test_json_says_the_same(self):
        run = doctor("--json")
        report = json.loads(run.stdout)
        self.assertEqual(report["exit_code"], run.returncode)
        names = [check["name"] for check in report["checks"]]
        for name in ("ptexp", "CUDA", "MPI", "CPU", "memory", "temporary files"):
            self.assertIn(name, names)
        version = subprocess.run([PTEXP, "--version"], capture_output=True, text=True, check=True)
        self.assertIn(f"commit {report['commit']}\n", version.stdout)
        self.assertIn(f"CUDA {report['cuda']}", version.stdout)

    def test_memory_and_threads_are_those_of_the_machine(self):
        machine = json.loads(doctor("--json").stdout)["machine"]
        total = re.search(r"MemTotal:\s*(\d+) kB", Path("/proc/meminfo").read_text("ascii"))
        self.assertEqual(machine["memory_bytes"], int(total.group(1)) * 1024)
        self.assertLessEqual(machine["threads"], os.cpu_count())
        flags = Path("/proc/cpuinfo").read_text("utf-8")
        self.assertLessEqual(machine["avx2"], " avx2 " in flags)
        self.assertLessEqual(machine["avx512"], " avx512f " in flags)

    def test_a_folder_for_temporary_files_that_is_not_there(self):
        with tempfile.TemporaryDirectory() as folder:
            run = doctor(env={**os.environ, "TMPDIR": f"{folder}/absent"})
        self.assertEqual(run.returncode, 1)
        self.assertRegex(run.stdout, r"(?m)^missing +temporary files .*\n +-> .*TMPDIR")

    def test_without_a_path_no_launcher_is_found(self):
        report = json.loads(doctor("--json", env={"PATH": ""}).stdout)
        mpi = next(check for check in report["checks"] if check["name"] == "MPI")
        self.assertEqual(mpi["status"], "warning")
        self.assertNotEqual(mpi["remedy"], "")


if __name__ == "__main__":
    unittest.main()
