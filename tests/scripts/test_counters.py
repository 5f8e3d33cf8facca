"""experiments/counters.py and scripts/counters_against_ncu with programs that make their answers up.
"""
import contextlib
import csv
import importlib.machinery
import importlib.util
import io
import json
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "experiments"))
import counters  # noqa: E402  pylint: disable=wrong-import-position
from lib import harness  # noqa: E402  pylint: disable=wrong-import-position

FIELDS = ["time_ms", "threads_per_instruction", "issue", "occupancy", "l1_hit_rate", "l2_hit_rate",
          "l2_bytes", "l2_read_bytes", "l2_written_bytes", "dram_read_bytes",
          "dram_written_bytes", "predicted_read_bytes", "predicted_written_bytes"]

# Renders of `cornell` are counted, others are forbidden; the way `cub` is refused.
FAKE = """#!/usr/bin/env python3
import json, sys
def option(name): return sys.argv[sys.argv.index(name) + 1]
if sys.argv[1] == "--list-devices":
    print("cuda:0     Fake GPU (1 SM)")
elif sys.argv[1] == "--version":
    print("ptexp 0\\ncommit abc")
elif "cub" in sys.argv:
    print("ptexp: error: no cub", file=sys.stderr)
    sys.exit(2)
else:
    total, kernel = KERNELS
    counters = {"problem": None, "samples": 1, "rays": 100, "total": total, "kernels": [kernel]}
    if option("--scene") != "cornell":
        counters = {"problem": "not allowed"}
    json.dump({"time_ms": {"kernel": {"median": 2.5}}, "counters": counters},
              open(option("--stats"), "w"))
"""


def load_script(name):
    loader = importlib.machinery.SourceFileLoader(name, str(ROOT / "scripts" / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


AGAINST_NCU = load_script("counters_against_ncu")


class Counters(unittest.TestCase):
    def setUp(self):
        few = {name: counters.VARIANTS[name] for name in ("megakernel", "uber", "cub")}
        for name, value in (("SCENES", ["cornell", "spheres"]), ("VARIANTS", few)):
            patch = mock.patch.object(counters, name, value)
            self.addCleanup(patch.stop)
            patch.start()
        folder = tempfile.TemporaryDirectory(prefix="ptexp counters ")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        total = {name: float(i) for i, name in enumerate(FIELDS)}
        kernel = {"kernel": "intersect", "launches": 7, **total, "l1_hit_rate": None}
        self.program = self.folder / "ptexp"
        self.program.write_text(
            FAKE.replace("KERNELS", f"json.loads({json.dumps([total, kernel])!r})"),
            encoding="utf-8")
        self.program.chmod(0o755)

    def run_counters(self):
        output, errors = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
            status = harness.main(
                counters.EXPERIMENT,
                ["--ptexp", str(self.program), "--quick", "--output", str(self.folder)],
                runner=counters.run)
        return status, output.getvalue() + errors.getvalue()

    def test_rows_are_kernels_and_what_cannot_be_counted_says_why(self):
        status, text = self.run_counters()
        self.assertEqual(status, 1, text)  # the forbidden ones have failed
        table, = self.folder.glob("*/counters-quick.csv")
        with open(table, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        measured = [row for row in rows if row["scene"] == "cornell" and row["variant"] != "cub"]
        self.assertEqual([row["kernel"] for row in measured],
                         [counters.ALL, "intersect"] * (len(counters.VARIANTS) - 1))
        self.assertEqual({row["status"] for row in measured}, {"measured"})
        self.assertEqual(measured[1]["launches"], "7")
        self.assertEqual(measured[1]["l1_hit_rate"], "")
        self.assertEqual(measured[0]["l1_hit_rate"], "4")
        self.assertEqual(measured[0]["render_ms"], "2.5")
        # fields 7 and 8 are moved, 11 and 12 predicted, by 100 rays
        self.assertEqual(measured[0]["l2_bytes_per_ray"], "0.15")
        self.assertEqual(measured[0]["predicted_bytes_per_ray"], "0.23")
        refused = [row for row in rows if row["variant"] == "cub"]
        self.assertEqual({row["status"] for row in refused}, {"refused"})
        self.assertIn("no cub", refused[0]["message"])
        failed = [row for row in rows if row["scene"] != "cornell" and row["variant"] != "cub"]
        self.assertEqual({(row["status"], row["message"]) for row in failed},
                         {("failed", "not allowed")})
        # Again: what was counted or refused is not tried again; what failed is, until it works.
        text = self.program.read_text(encoding="utf-8")
        log = 'elif "cub" in sys.argv:\n    open(__file__ + ".log", "a").write("cub ")\n'
        text = text.replace('elif "cub" in sys.argv:\n', log).replace(
            "    total, kernel", '    open(__file__ + ".log", "a").write(option("--scene") + " ")\n    total, kernel')
        for mended in (text, text.replace('!= "cornell"', '== "nothing"')):
            self.program.write_text(mended, encoding="utf-8")
            status, _ = self.run_counters()
        log = Path(f"{self.program}.log").read_text(encoding="utf-8").split()
        self.assertEqual((status, log), (0, 4 * ["spheres"]))
        self.assertTrue(json.loads(table.with_suffix(".json").read_text(encoding="utf-8"))["complete"])
        self.assertIn("measured already", self.run_counters()[1])

    def test_nothing_counted_writes_nothing(self):
        self.program.write_text(self.program.read_text(encoding="utf-8").replace("cornell", "none"),
                                encoding="utf-8")
        status, text = self.run_counters()
        self.assertEqual(status, 2)
        self.assertIn("not allowed", text)
        self.assertEqual(list(self.folder.glob("*/*.csv")), [])


class AgainstNcu(unittest.TestCase):
    TABLE = '\n'.join([
        "==PROF== Connected to process 1",
        '"ID","Kernel Name","gpu__time_duration.sum","smsp__inst_executed.sum",'
        '"smsp__thread_inst_executed_per_inst_executed.ratio"',
        '"","","ns","inst",""',
        '"0","void pt::stage_kernel<pt::GeneratePaths<PhiloxSource>, 0>(int)","1","1","1"',
        '"1","void pt::stage_kernel<pt::ShadeSurface<pt::Traits<0, 1>>, 0>(int)",'
        '"1,000","30","32"',
        '"2","void pt::stage_kernel<pt::ShadeSurface<pt::Traits<1, 1>>, 0>(int)",'
        '"2000","10","16"', ""])

    def test_tables_of_ncu(self):
        launches = AGAINST_NCU.parse_ncu(self.TABLE)
        self.assertEqual([AGAINST_NCU.name_of(kernel) for kernel, _ in launches],
                         ["generate", "shade_surface", "shade_surface"])
        self.assertEqual(launches[1][1]["gpu__time_duration.sum"], 1000)
        with self.assertRaises(harness.HarnessError):
            AGAINST_NCU.parse_ncu("==ERROR== ERR_NVGPUCTRPERM")

    def test_launches_are_paired_from_the_end(self):
        launches = AGAINST_NCU.parse_ncu(self.TABLE)
        ours = [{"kernel": "shade_surface"}, {"kernel": "shade_surface"}]
        groups = AGAINST_NCU.pair_launches(ours, launches)
        group = groups["shade_surface"]
        self.assertEqual(AGAINST_NCU.value_of(group, "gpu__time_duration.sum", 1e-3, None), 3)
        # 30 instructions of 32 threads, 10 of 16
        self.assertEqual(AGAINST_NCU.value_of(
            group, "smsp__thread_inst_executed_per_inst_executed.ratio", 1,
            "smsp__inst_executed.sum"), 28)
        with self.assertRaises(harness.HarnessError):
            AGAINST_NCU.pair_launches([{"kernel": "intersect"}], launches)

    def test_quantities_are_those_of_ptexp(self):
        self.assertLessEqual(set(AGAINST_NCU.QUANTITIES), set(FIELDS))
        values = dict.fromkeys(AGAINST_NCU.QUANTITIES, 3.0)
        metrics = {name: 1.0 for metric, _, weight in AGAINST_NCU.QUANTITIES.values()
                   for name in (metric, weight) if name}
        rows = AGAINST_NCU.compare(
            {"kernels": [{"kernel": "shadow", "launches": 1, **values}]}, {"shadow": [metrics]},
            ["--spp", "1"])
        self.assertEqual({row["quantity"] for row in rows}, set(values))
        ratios = {row["quantity"]: row["ratio"] for row in rows}
        self.assertEqual(ratios["l2_bytes"], "3.0000")
        self.assertEqual(ratios["l2_read_bytes"], "0.0938")  # sectors of 32 bytes


if __name__ == "__main__":
    unittest.main()
