"""experiments/law.py on tables that a known law has made."""
import contextlib
import csv
import io
import json
import math
import random
import shutil
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "experiments"))
import law as experiment  # noqa: E402  pylint: disable=wrong-import-position
from lib import harness, law  # noqa: E402  pylint: disable=wrong-import-position
sys.path.insert(0, str(ROOT / "scripts"))
from report_parts.plots import draw_panels  # noqa: E402  pylint: disable=wrong-import-position
from report_parts.tables import read_table  # noqa: E402  pylint: disable=wrong-import-position
from report_parts.verdicts import meaning  # noqa: E402  pylint: disable=wrong-import-position

KNOWN = {"constant": math.log(1.3), "drain": 0.5, "shadow": -0.8, "sorted": -0.1}
UNITS, BLOCK = 100, 640
BLOCK_LOCAL = f"start:8:0:0:1:0.5;megakernel:96:0:{120 << 10}:{BLOCK}:0.3125"
LOOP = "megakernel:64:0:0:256:0.5"


def pair(scene, size, depth, rays, shadow, *, is_sorted=False, factor=1.0, **more):
    """Rows of both modes, whose ratio is that of the known law, times `factor`."""
    paths = 16 * size * size
    wave = {"status": "measured", "scene": scene, "mode": "wavefront", "device_kind": "cuda", "width": size,
            "height": size, "spp": 16, "max_depth": depth, "paths": paths, "rays": rays * paths,
            "shadow_rays": shadow * paths, "order_surfaces_launches": 3 if is_sorted else "",
            "finish_ms_median": "", "kernel_ms_median": 10.0, "accel": "auto", "used_accel": "cwbvh",
            "kernels": "intersect:64:0:0:512:0.5", **more}
    terms = {"constant": 1, "drain": min(1, law.SLOTS * UNITS * BLOCK / paths), "shadow": shadow / (rays + shadow),
             "sorted": math.log(rays) if is_sorted else 0}
    ratio = factor * math.exp(sum(KNOWN[name] * terms[name] for name in KNOWN))
    return [{**wave, "mode": "megakernel", "kernel_ms_median": 10 * ratio, "finish_ms_median": "",
             "order_surfaces_launches": "", "kernels": more.get("mega", BLOCK_LOCAL)}, wave]


def scenes(noise=0.0):
    """Five families of scenes, each in several sizes and depths."""
    draw, rows = random.Random(7), []
    for number, family in enumerate(("a", "b", "c", "folder/d/scene.xml", "e")):
        for size in (128, 256, 512, 2048):
            for depth in (4, 8, 16):
                name = family if "/" in family else f"{family}:{size}"
                rows += pair(name, size, depth, 2 + depth / 2 + number / 7, 0.4 * number + depth / 40,
                             is_sorted=number % 2 == 1, factor=math.exp(draw.gauss(0, noise)))
    return rows


def cells(rows):
    texts = [{key: str(value) for key, value in row.items()} for row in rows]
    return law.cells_of({"sizes": texts}, UNITS)


class Law(unittest.TestCase):
    def test_planted_coefficients_are_found(self):
        found = law.fit(cells(scenes()))
        for name, value in KNOWN.items():
            self.assertAlmostEqual(found[name], value, 6, name)
        noisy = cells(scenes(0.05))
        self.assertEqual(len(noisy), 60)
        ends = law.intervals(noisy)
        for name, value in KNOWN.items():
            low, high = ends[name]
            self.assertLess(low - 0.1, value, name)
            self.assertGreater(high + 0.1, value, name)
            self.assertLess(high - low, 0.6, name)

    def test_leave_one_out_leaves_out(self):
        rows = scenes() + [row for size in (128, 256, 512, 2048) for depth in (4, 8) for row in pair(
            f"odd:{size}", size, depth, 4, 0.5, factor=2)]
        unseen = law.leave_one_out(cells(rows))
        odd = [one for one in unseen if one.cell.family == "odd"]
        self.assertEqual(len(odd), 8)
        for one in odd:  # a law that had seen them would be nearer
            self.assertAlmostEqual(one.error, -0.5, 6)
        by_fit = [law.predicted(law.fit(cells(rows)), one.cell) / one.cell.ratio - 1 for one in odd]
        self.assertLess(max(map(abs, by_fit)), 0.45)
        near, count, spread = law.hits(one.error for one in law.leave_one_out(cells(scenes())))
        self.assertEqual((near, count), (60, 60))
        self.assertLess(spread, 1e-9)

    def test_scene_files_are_predicted_by_built_in_scenes(self):
        rows = [row for row in scenes() if "/" not in row["scene"]]
        rows += pair("folder/d/scene.xml", 512, 8, 5, 1, factor=3)
        one, = law.on_files(cells(rows))
        self.assertAlmostEqual(one.error, 1 / 3 - 1, 6)

    def test_a_scene_outside_of_the_range_is_unknown(self):
        far = law.leave_one_out(cells(scenes() + pair("far", 512, 8, 4, 40)))[-1]
        self.assertEqual((far.cell.family, far.verdict), ("far", "unknown: outside in shadow"))
        self.assertNotIn("outside", [one.verdict for one in law.leave_one_out(cells(scenes()))
                                     if one.cell.family == "b"][0])

    def test_it_says_when_the_interval_has_1(self):
        cell = law.Cell("x", "x", False, "sizes", 1.0, {})
        for ratio, width, verdict in ((1.2, 1.1, "wavefront"), (0.8, 1.1, "megakernel"),
                                      (1.05, 1.1, "unknown: near 1"), (0.95, 1.1, "unknown: near 1")):
            self.assertEqual(law.Unseen(cell, ratio, [], width).verdict, verdict)

    def test_other_kernels_and_other_options_are_no_cells(self):
        loop, = cells(pair("l", 512, 8, 4, 1, mega=LOOP))
        self.assertEqual((loop.other, loop.terms), ("the megakernel is a loop", {}))
        tree, = cells(pair("t", 512, 8, 4, 1, used_accel="bvh2"))
        self.assertEqual(tree.other, "no wide tree")
        self.assertEqual(cells(pair("o", 512, 8, 4, 1, accel="bvh2")), [])
        self.assertEqual(cells(pair("o", 512, 8, 4, 1, variant="auto")), [])
        self.assertEqual(cells(pair("o", 512, 8, 4, 1)[:1]), [])

    def test_hits(self):
        self.assertEqual(law.hits([0.05, -0.11, 0.1])[:2], (2, 3))

    def test_families_count_alike(self):
        nothing = {"constant": 1, "drain": 0, "shadow": 0, "sorted": 0}
        many = [law.Cell(str(i), "many", False, "sizes", 4.0, nothing) for i in range(9)]
        found = law.fit([law.Cell("x", "few", False, "sizes", 1.0, nothing), *many])
        self.assertAlmostEqual(math.exp(found["constant"]), 2, 9)

    def test_terms_of_a_row(self):
        cell, = cells(pair("t", 2048, 8, 3, 1, is_sorted=True, finish_ms_median=2.5))
        flying = law.SLOTS * UNITS * BLOCK
        self.assertEqual(cell.terms, {"constant": 1, "drain": 0.75 * flying / (16 * 2048 * 2048), "shadow": 0.25,
                                      "sorted": math.log(3)})

    def test_terms_that_no_cell_has_are_left_out(self):
        found = law.fit(cells([row for row in scenes() if not row["scene"].startswith(("b", "folder"))]))
        self.assertEqual(set(found), {"constant", "drain", "shadow"})
        self.assertIsNone(law.fit(cells(pair("a", 512, 8, 4, 1))))


class Table(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="ptexp law ")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def plant(self, rows, commit="abc"):
        columns = list(dict.fromkeys(column for row in rows for column in row))
        with open(self.folder / "sizes.csv", "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, columns)
            writer.writeheader()
            writer.writerows(rows)
        (self.folder / "sizes.json").write_text(json.dumps({
            "program": ["ptexp 1", f"commit {commit}"], "date": "2026-01-02T03:04:05+00:00", "complete": True,
            "device": {"choice": "cuda:0", "name": "G", "detail": f"{UNITS} multiprocessors, 1 GiB"},
            "gpus": [], "host": {"cpu": "C"}}), encoding="utf-8")

    def run_law(self):
        output, errors = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
            code = harness.main(experiment.EXPERIMENT, ["--tables", str(self.folder)], runner=experiment.run)
        return code, output.getvalue() + errors.getvalue()

    def test_table_and_provenance(self):
        self.plant(scenes() + pair("far", 512, 8, 4, 40) + pair("loop", 512, 8, 4, 1, mega=LOOP))
        code, text = self.run_law()
        self.assertEqual(code, 0, text)
        self.assertIn("The goal of 90% within 10% for unseen scenes is reached", text)
        self.assertIn("outside in shadow (a, far); the megakernel is a loop (loop)", text)
        with open(self.folder / "law.csv", newline="", encoding="utf-8") as file:
            rows = {row["name"]: row for row in csv.DictReader(file)}
        self.assertEqual(rows["loop 512x512x16, depth 8"]["predicted_median"], "")
        row = rows["a:512 512x512x16, depth 8"]
        self.assertEqual(row["predicted_median"], row["measured"])
        facts = json.loads((self.folder / "law.json").read_text(encoding="utf-8"))
        self.assertEqual(facts["tables"]["sizes"]["commit"], "abc")
        self.assertAlmostEqual(facts["law"]["constant"]["factor"], 1.3, 1)
        self.assertTrue(facts["complete"])

    def test_the_report_draws_it_and_says_it(self):
        self.plant(scenes() + pair("loop", 512, 8, 4, 1, mega=LOOP))
        self.run_law()
        table = read_table(self.folder / "law.csv")
        (_, _, content), = draw_panels(table)
        self.assertEqual(content.count('class="marker"'), 60)  # none of the loop
        self.assertEqual((content.count('class="mark"'), "<polyline" in content), (2, False))  # 1, diagonal
        self.assertEqual([text for _, text in meaning(table)], table.facts["conclusions"])

    def test_the_committed_law_is_that_of_the_committed_tables(self):
        results = ROOT / "results" / "nvidia-h200"
        for name in law.TABLES:
            for ending in ("csv", "json"):
                shutil.copy(results / f"{name}.{ending}", self.folder)
        self.assertEqual(self.run_law()[0], 0)
        for ending in ("csv", "json"):
            texts = [(folder / f"law.{ending}").read_text(encoding="utf-8") for folder in (self.folder, results)]
            if ending == "json":
                texts = [{key: value for key, value in json.loads(text).items() if key != "command"}
                         for text in texts]
            self.assertEqual(texts[0], texts[1], "experiments/law.py --tables results/nvidia-h200 makes it anew")

    def test_new_tables_give_new_coefficients(self):
        factors = []
        for factor in (1.0, 1.5):
            rows = scenes()
            for row in rows:
                row["kernel_ms_median"] *= factor if row["mode"] == "megakernel" else 1
            self.plant(rows)
            self.run_law()
            facts = json.loads((self.folder / "law.json").read_text(encoding="utf-8"))
            factors.append(facts["law"]["constant"]["factor"])
        self.assertAlmostEqual(factors[1] / factors[0], 1.5, 3)

    def test_too_few_cells_and_no_tables(self):
        self.assertIn("measure them first", self.run_law()[1])
        self.plant(scenes()[:8])
        code, text = self.run_law()
        self.assertEqual(code, 2)
        self.assertIn("do not tell 4 terms", text)
        self.assertFalse((self.folder / "law.csv").exists())


if __name__ == "__main__":
    unittest.main()
