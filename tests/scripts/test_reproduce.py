"""scripts/reproduce: it knows every experiment, and one that fails stops no other.

The environment variable PTEXP names the executable (build/release/src/ptexp).
"""
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PTEXP = Path(os.environ.get("PTEXP", ROOT / "build" / "release" / "src" / "ptexp")).resolve()
REPRODUCE = ROOT / "scripts" / "reproduce"
# They need another build, or RT cores.
NOT_IN_IT = {"compare_builds", "divergence", "hardware", "motion"}
BUDGET_S = {"all": 36 * 60, "ten": 600, "minute": 60}

# A ptexp that dies where it is to keep states of random numbers, unless the file `mended` is there.
PARTLY_BROKEN = """#!/bin/sh
[ "$1" = measure ] || exec '{program}' "$@"
while read -r line; do
  case "$line" in *'"--rng", "xorwow"'*) [ -e '{folder}/mended' ] || exit 3 ;; esac
  printf '%s\\n' "$line"
done | '{program}' measure
"""
# A ptexp on a machine of so many GPUs.
WITH_GPUS = """#!/bin/sh
[ "$1" = --list-devices ] && for i in {numbers}; do echo "cuda:$i     Fake (2 units)"; done
[ "$1" != --list-devices ] || exit 0
echo "ptexp: error: nothing renders here" >&2
exit 2
"""


def reproduce(*arguments):
    return subprocess.run([sys.executable, REPRODUCE, *map(str, arguments)], capture_output=True,
                          text=True, check=False, timeout=600)


class Reproduce(unittest.TestCase):
    def test_every_experiment_is_in_it(self):
        done = reproduce("--list")
        *steps, total = re.findall(r"(?m)^(\w+) +(\d+) s", done.stdout)
        scripts = {path.stem for path in (ROOT / "experiments").glob("*.py")
                   if "harness.main(" in path.read_text(encoding="utf-8")}
        self.assertEqual({name for name, _ in steps}, scripts - NOT_IN_IT)
        seconds = sum(int(of_step) for _, of_step in steps)
        self.assertEqual(total, ("all", str(seconds)))
        self.assertLess(seconds, BUDGET_S["all"])
        self.check_commands(done.stdout)

    def check_commands(self, text):
        """That the experiments accept them; returns what each would measure."""
        found = {}
        for line in text.splitlines()[:-1]:
            script, *options = line.partition(" s  ")[2].split()
            listed = subprocess.run(
                [sys.executable, script, *options, "--ptexp", PTEXP, "--device", "cpu", "--list",
                 "--quick", "--output", tempfile.gettempdir()],
                capture_output=True, text=True, check=False)
            self.assertEqual(listed.returncode, 0, listed.stderr)
            found[line.split()[0]] = listed.stdout
        return found

    def test_smaller_tiers(self):
        every = [line.split()[0] for line in reproduce("--list").stdout.splitlines()]
        names = {}
        for tier in ("ten", "minute"):
            done = reproduce("--tier", tier, "--list", "--output", "out")
            *steps, total = re.findall(r"(?m)^(\w+) +(\d+) s", done.stdout)
            names[tier] = [name for name, _ in steps]
            self.assertEqual(total, (tier, str(sum(int(seconds) for _, seconds in steps))))
            self.assertLess(int(total[1]), BUDGET_S[tier])
            self.assertEqual(done.stdout.count(f" --output out/{tier}"), len(steps))
            measured = self.check_commands(done.stdout)
            for mode in ("megakernel", "wavefront"):
                self.assertIn(f"--mode {mode} --scene cornell ", measured["defaults"])
        self.assertEqual(names["ten"], [name for name in every if name in names["ten"]])
        self.assertEqual(names["minute"], ["defaults"])
        self.assertLess(set(names["minute"]), set(names["ten"]))
        wrong = reproduce("--tier", "minute", "--only", "depth")
        self.assertEqual(wrong.returncode, 2)
        self.assertIn("--only depth: expected some of defaults", wrong.stderr)

    def test_scaling_wants_several_gpus(self):
        with tempfile.TemporaryDirectory(prefix="ptexp reproduce ") as name:
            program = Path(name) / "ptexp"
            for numbers, outcome in (("0", "needs several GPUs"), ("0 1 2", "FAILED, exit code 2")):
                program.write_text(WITH_GPUS.format(numbers=numbers), encoding="utf-8")
                program.chmod(0o755)
                done = reproduce("--only", "scaling", "--ptexp", program, "--output", name)
                self.assertRegex(done.stdout, rf"(?m)^scaling +\d+ s  {outcome}$")
            listed = subprocess.run(
                [sys.executable, ROOT / "experiments" / "scaling.py", "--list", "--ptexp", program],
                capture_output=True, text=True, check=True).stdout
            self.assertEqual(re.findall(r"--device (\S+)", listed),
                             2 * ["cuda:0", "cuda:0,1", "cuda:0,1,2"])

    def test_what_it_does_not_know(self):
        for arguments, text in ((["--only", "toggles,nothing"], "expected some of speed_targets"),
                                (["--ptexp", "/nowhere/ptexp"], "no program /nowhere/ptexp")):
            done = reproduce(*arguments)
            self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), done.stderr)
            self.assertIn(text, done.stderr)

    def test_one_that_fails_stops_no_other(self):
        with tempfile.TemporaryDirectory(prefix="ptexp reproduce ") as name:
            folder = Path(name)
            program = folder / "ptexp"
            program.write_text(PARTLY_BROKEN.format(folder=folder, program=PTEXP), encoding="utf-8")
            program.chmod(0o755)
            command = ["--quick", "--device", "cpu", "--ptexp", program, "--output", folder / "out",
                       "--only", "toggles,block_size,depth"]
            first = reproduce(*command)
            self.assertEqual(first.returncode, 1, first.stderr)
            for line in (r"toggles +\d+ s  FAILED, exit code 1", r"block_size +\d+ s  needs a GPU",
                         r"depth +\d+ s  done"):
                self.assertRegex(first.stdout, line)
            self.assertRegex(first.stdout, r"=== 3 of 3: depth  \(about \d+ s left over all\)")
            self.assertEqual(len(list(folder.glob("out/*/report.html"))), 1)
            (folder / "mended").touch()
            second = reproduce(*command)
            self.assertEqual(second.returncode, 0, second.stdout + second.stderr)
            self.assertRegex(second.stdout, r"goes on: \d\d of \d\d measurements are done already")
            self.assertIn("measured already by this program and command", second.stdout)
            # Parts of one run may be calls of their own: nothing of them is measured again.
            third = reproduce(*command[:-1], "depth,toggles")
            self.assertEqual(third.returncode, 0, third.stdout + third.stderr)
            self.assertEqual(third.stdout.count("measured already by this program and command"), 2)


if __name__ == "__main__":
    unittest.main()
