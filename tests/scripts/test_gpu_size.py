"""experiments/gpu_size.py with a program that makes its times up: those of a GPU of 132
multiprocessors, on which the wavefront scales and the megakernel stops at 64."""
import contextlib
import csv
import io
import json
import sys
import tempfile
import types
import unittest
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "experiments"))
import gpu_size  # noqa: E402  pylint: disable=wrong-import-position
from lib import harness  # noqa: E402  pylint: disable=wrong-import-position

FAKE = """#!/usr/bin/env python3
import json, sys
def option(name, default): return sys.argv[sys.argv.index(name) + 1] if name in sys.argv else default
def answer():
    sms = int(option("--sms", 132))
    if sms == REFUSED:
        return {"error": "--sms %d: the driver gives 24" % sms, "exit_code": 2}
    is_mega = option("--mode", "") == "megakernel"
    time = 640 / min(sms, 64) if is_mega else 1280 / sms
    if is_mega and "--shared-memory-max" in sys.argv: time *= 10
    row = dict.fromkeys(["mpaths_per_s", "rays", "shadow_rays", "scene_ms"], "1")
    row.update((f"kernel_ms_{part}", str(time)) for part in ("median", "min", "max"))
    row.update(paths="1000000", repeat=option("--repeat", "1"))
    runs = [{"kernel_ms": time * (1 + 0.001 * i), "stages": []} for i in range(int(row["repeat"]))]
    return {"row": row, "statistics": {"runs": runs}}
if sys.argv[1] == "--list-devices":
    print("cpu        CPU (2 threads)\\ncuda:0     Fake GPU (132 multiprocessors, 80.0 GiB)")
elif sys.argv[1] == "--version":
    print("ptexp 0\\ncommit abc")
elif sys.argv[1] == "compare":
    print("differing pixels       0")
elif sys.argv[1] == "measure":
    for line in sys.stdin:
        sys.argv[1:] = json.loads(line)["arguments"]
        print(json.dumps(answer()), flush=True)
else:
    open(option("--output", ""), "w").write("image")
"""


class GpuSize(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="ptexp sizes ")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_it(self, *arguments, refused=0):
        """(exit code, what was printed)"""
        program = self.folder / "ptexp"
        program.write_text(FAKE.replace("REFUSED", str(refused)), encoding="utf-8")
        program.chmod(0o755)
        output = io.StringIO()
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
            status = harness.main(gpu_size.EXPERIMENT, ["--ptexp", str(program), "--output",
                                                        str(self.folder / "out"), *arguments])
        return status, output.getvalue()

    def table(self, name="gpu_size"):
        path, = self.folder.glob(f"out/*/{name}.csv")
        with open(path, newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file)), json.loads(path.with_suffix(".json").read_text())

    def test_speeds_ratios_and_sentences(self):
        few = {name: gpu_size.SCENES[name] for name in ("cornell",)}
        with mock.patch.object(gpu_size, "SCENES", few):
            status, text = self.run_it("--rounds", "2", "--repeat", "3")
        self.assertEqual(status, 0, text)
        rows, facts = self.table()
        self.assertEqual(len(rows), 2 * 2 * 6)
        panel = [row for row in rows if row["panel"] == "cornell, 256x256"]
        of = {(row["variant"], row["multiprocessors"], row["block_kib"]): row for row in panel}
        for sms in (8, 16, 32, 64, 132):
            mega, wave = (of[mode, str(sms), ""] for mode in ("megakernel", "wavefront"))
            self.assertAlmostEqual(1.28 * float(wave["speed_median"]), 1, 2)
            self.assertLessEqual(float(wave["speed_low"]), float(wave["speed_median"]))
            self.assertGreaterEqual(float(wave["speed_high"]), float(wave["speed_median"]))
            self.assertAlmostEqual(0.64 * float(mega["speed_median"]), min(1, 64 / sms), 2)
            self.assertAlmostEqual(float(wave["ratio_median"]), max(sms, 64) / 128, 3)
            self.assertEqual(wave["x"], str(sms))
        self.assertEqual(of["wavefront", "32", "64"]["x"], "")
        self.assertAlmostEqual(float(of["wavefront", "32", "64"]["ratio_median"]), 5, 3)
        self.assertEqual([line for line in facts["conclusions"] if line.startswith("cornell, 256")], [
            "cornell, 256x256: faster is the megakernel on 8, 16, 32 and 64 (at most 2.00 times), "
            "the wavefront on 132 (at most 1.03 times)",
            "cornell, 256x256: 16.5 times the multiprocessors are 8.00 times as fast in the "
            "megakernel and 16.5 times as fast in the wavefront",
            "cornell, 256x256, 32 multiprocessors and blocks of 64 KiB: faster is the wavefront, "
            "5.00 times"])

    def test_a_size_that_the_driver_refuses_costs_its_rows_alone(self):
        status, text = self.run_it("--quick", "--sms", "8", refused=8)
        self.assertEqual(status, 0, text)
        rows, facts = self.table("gpu_size-quick")
        self.assertEqual({(row["multiprocessors"], row["status"]) for row in rows},
                         {("8", "refused"), ("132", "measured")})
        self.assertIn("--sms 8: the driver gives 24", rows[0]["message"])
        self.assertEqual(len(facts["conclusions"]), 2)

    def test_the_commands(self):
        status, text = self.run_it("--list", "--scenes", "room/scene.xml", "--sms", "8", "200")
        self.assertEqual(status, 0, text)
        lines = text.splitlines()
        self.assertEqual(len(lines), 6 * 2 * 2 * 2)  # 200 are more than there are
        self.assertEqual(sum("--sms 8 " in line for line in lines), len(lines) / 2)
        self.assertEqual(sum("--sms" not in line for line in lines), len(lines) / 2)
        self.assertEqual(sum(str(Path("room/scene.xml").resolve()) in line for line in lines), 8)

    def test_images_of_the_ends_are_compared(self):
        arguments = types.SimpleNamespace(quick=False, scenes=[], sms=gpu_size.SIZES)
        device = types.SimpleNamespace(kind="cuda", detail="132 multiprocessors, 80 GiB")
        made = gpu_size.configurations(arguments, device)
        compared = [one for one in made if one.same_image == "fog"]
        self.assertEqual({(one.labels["multiprocessors"], one.labels["block_kib"])
                          for one in compared}, {(8, ""), (32, 64), (132, "")})

    def test_a_cpu_is_refused(self):
        status, text = self.run_it("--device", "cpu")
        self.assertEqual(status, 2)
        self.assertIn("needs a GPU, and --device cpu is a CPU", text)


if __name__ == "__main__":
    unittest.main()
