"""Claims on trial: wrong files, verdicts on tables whose numbers are known, and those on the committed
tables, which the committed pages must say."""
import dataclasses
import re
import subprocess
import sys
import tempfile
import types
import unittest
from html import unescape
from pathlib import Path
from unittest import mock

import test_report as planted

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "experiments"))
from lib import claim_files, claims, intervals  # noqa: E402
from lib.claim_rules import Cell, cells_of  # noqa: E402
from report_parts.claims import markdown  # noqa: E402
from report_parts.tables import Device, Table, read_device  # noqa: E402

GOOD = '''claim = "A is twice as fast as B."
citation = "Somebody 2020, 'A Title'"
source_read = true
source_note = "All of it."
number = "2 times"
conditions = "One GPU."
ours = "Another."
'''
RULE = '''
[rule]
table = "toggles"
measures = "time of B / time of A"
numerator = { x = "B" }
denominator = { x = "A" }
for_each = { scene = "panel" }
at_least = 2
'''
LACKS = '''
[lacks]
what = "a thing"
takes = "work"
'''
# Their rows are of an experiment that has them since, but were not measured yet.
UNMEASURED = set()  # names of claims whose tables lack rows yet
DEVICES = sorted({path.parent for path in (ROOT / "results").glob("*/*.json")
                  if path.parent.name != "submissions"})


def row(panel, x, low, middle, high, **more):
    return {"panel": panel, "x": x, "status": "measured", "commit": "abcdefghij",
            "kernel_ms_median": str(middle), "kernel_ms_low": str(low), "kernel_ms_high": str(high),
            **{key: str(value) for key, value in more.items()}}


def pair(panel, ratio, spread=0.01):
    """A takes 1 ms and B so many times as long."""
    return [row(panel, "A", 1 - spread, 1, 1 + spread),
            row(panel, "B", ratio * (1 - spread), ratio, ratio * (1 + spread))]


def device(rows, name="toggles", **facts):
    return Device(None, "D", {name: Table(name, [], rows, facts)})


def claim_of(rule="", **more):
    """The claim that A is twice as fast as B; `rule`: lines that replace those of the same keys."""
    kept = [line for line in RULE.splitlines()
            if line.partition(" =")[0] not in {one.partition(" =")[0] for one in rule.splitlines()}]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "planted.toml"
        path.write_text(GOOD + "\n".join(kept) + f"\n{rule}\n", encoding="utf-8")
        return dataclasses.replace(claim_files.read_claim(path), **more)


class Files(unittest.TestCase):
    def error_of(self, text):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "mine.toml"
            path.write_text(text, encoding="utf-8")
            with self.assertRaises(claim_files.ClaimError) as caught:
                claim_files.read_claim(path)
        return str(caught.exception)

    def test_what_is_wrong_is_named_with_file_and_key(self):
        for text, said in (
                (GOOD + 'colour = "red"\n' + RULE, "mine.toml: colour: unknown key"),
                (GOOD + RULE + 'eval = "1 + 1"', "mine.toml: rule.eval: unknown key"),
                (GOOD + LACKS + 'cost = "much"', "mine.toml: lacks.cost: unknown key"),
                (GOOD.replace("true", '"yes"') + RULE, "mine.toml: source_read: expected true or false"),
                (GOOD + RULE.replace("2", '"2"'), "mine.toml: rule.at_least: expected a number"),
                (GOOD + RULE.replace('{ x = "B" }', "{ x = 2 }"),
                 "mine.toml: rule.numerator: expected a selection"),
                (GOOD + RULE.replace('{ scene = "panel" }', '["panel"]'),
                 "mine.toml: rule.for_each: expected texts"),
                (GOOD.replace("citation", "# citation") + RULE, "mine.toml: citation: missing"),
                (GOOD.replace('"One GPU."', '""') + RULE, "mine.toml: conditions: missing"),
                (GOOD + RULE.replace("denominator", "# "), "mine.toml: rule.denominator: missing"),
                (GOOD + RULE.replace("table", "# "), "mine.toml: rule.table: missing"),
                (GOOD + RULE.replace("at_least", "# "), "mine.toml: rule.at_least: missing"),
                (GOOD + RULE + 'statistic = "sum"', "mine.toml: rule.statistic: expected one of ratio"),
                (GOOD + RULE + 'statistic = "steps"', "mine.toml: rule.along: missing"),
                (GOOD + RULE + "assumed_spread = 0.1", "mine.toml: rule.assumed_because: goes with"),
                (GOOD + RULE + LACKS, "mine.toml: rule: a claim has either"),
                (GOOD, "mine.toml: rule: a claim has either"),
                (GOOD + "rule = 3", "mine.toml: rule: expected a table"),
                ("claim = ", "mine.toml: not TOML")):
            self.assertIn(said, self.error_of(text))

    def test_python_3_10_reads_with_tomli_and_says_so_where_it_lacks_it(self):
        with mock.patch.dict(sys.modules, {"tomllib": None, "tomli": types.SimpleNamespace(
                loads=lambda text: {"claim": "read by tomli", "colour": "red"})}):
            self.assertIn("mine.toml: colour: unknown key", self.error_of(GOOD + RULE))
        with mock.patch.dict(sys.modules, {"tomllib": None, "tomli": None}):
            self.assertIn("pip install -r scripts/requirements.txt", self.error_of(GOOD + RULE))

    def test_ours_are_as_they_should_be(self):
        found = {claim.name: claim for claim in claim_files.read_claims()}
        self.assertGreaterEqual(len(found), 27)
        self.assertEqual(sum(name.startswith("paper_") for name in found), 7)
        for name in ("laine_2013", "aila_2009", "aila_2012", "ylitie_2017", "meister_2020", "padilla",
                     "novak_2010", "pbrt_125", "cuda_13", "vk_gltf_29", "three_775", "three_770",
                     "benthin_2024", "burley_2020", "conty_2018", "veach_1997"):
            self.assertTrue(any(key.startswith(name) for key in found), name)
        for claim in found.values():
            self.assertRegex(claim.citation, r"(19|20)\d\d|no date|\(README\.md\)", claim.name)

    def test_each_table_is_made_by_an_experiment(self):
        for claim in claim_files.read_claims():
            if claim.lacks:
                continue
            name = claim.rule["table"].partition("-")[0]
            script = ROOT / "experiments" / f"{name}.py"
            self.assertTrue(script.is_file(), f"{claim.name}: no experiment makes {name}")
            self.assertRegex(script.read_text(encoding="utf-8"), rf'Experiment\(\s*"{name}"', claim.name)
            self.assertTrue(claims.command_for(claim.rule).startswith(f"experiments/{name}.py"), claim.name)

    def test_columns_and_values_of_rules_are_those_of_the_committed_tables(self):
        tables = read_device(planted.RESULTS).tables
        for claim in claim_files.read_claims():
            table = tables.get(claim.rule.get("table"))
            if table:
                used = {column for key in ("where", "numerator", "denominator")
                        for column in claim.rule.get(key, {})}
                used |= {column for key in ("for_each", "vary") for column in
                         claim.rule.get(key, {}).values()}
                used |= {claim.rule[key] for key in ("along", "last_of", "times", "per")
                         if key in claim.rule}
                self.assertLessEqual(used, set(table.columns) | {"panel", "x"}, claim.name)
                self.assertEqual(bool(cells_of(table, claim.rule)), claim.name not in UNMEASURED,
                                 claim.name)


class Verdicts(unittest.TestCase):
    def kind(self, rows, rule="", **facts):
        return claims.judge(claim_of(rule), device(rows, **facts))

    def test_the_four(self):
        good, bad = pair("room", 3), pair("box", 1.5)
        for rows, text in (
                (good, "reproduced"), (bad, "refuted"),
                (good + bad, "holds only when scene is room (1 of 2 cases)"),
                ([], "cannot be judged here: toggles has no such rows; experiments/toggles.py measures "
                     "them")):
            verdict = self.kind(rows)
            self.assertEqual(verdict.text, text)
            self.assertTrue(verdict.text.startswith(verdict.kind))
        verdict = self.kind(good)
        # The ends that the ends of both allow: 2.97 / 1.01 and 3.03 / 0.99.
        self.assertEqual((verdict.numbers, verdict.commit, verdict.table),
                         ("3.00 [2.94, 3.06] (room)", "abcdefg", "toggles"))
        self.assertEqual(self.kind(good + bad).numbers,
                         "1.50 [1.47, 1.53] (box) to 3.00 [2.94, 3.06] (room), 2 cases")

    def test_an_interval_that_contains_the_bound_decides_nothing(self):
        for ratio in (1.99, 2, 2.01):
            self.assertEqual(self.kind(pair("room", ratio)).text,
                             "cannot be judged here: the interval contains a bound")
        unclear = pair("hall", 2)
        self.assertEqual(self.kind(unclear + pair("room", 3)).text,
                         "holds only when scene is room (1 of 2 cases)")
        self.assertEqual(self.kind(unclear + pair("box", 1)).text,
                         "refuted (1 of 2 cases; the others' intervals contain a bound)")
        self.assertEqual(self.kind(unclear + pair("den", 2)).text,
                         "cannot be judged here: the intervals contain a bound")

    def test_both_bounds(self):
        rule = "at_least = 2\nat_most = 4"
        for ratio, kind in ((1.5, "refuted"), (3, "reproduced"), (5, "refuted"),
                            (4, "cannot be judged here")):
            self.assertEqual(self.kind(pair("room", ratio), rule).kind, kind, ratio)

    def test_without_a_spread_nothing_is_decided_unless_one_is_assumed(self):
        rows = [{**one, "kernel_ms_low": "", "kernel_ms_high": ""} for one in pair("room", 3)]
        self.assertEqual(self.kind(rows).text, "cannot be judged here: the table has no intervals")
        verdict = self.kind(rows, 'assumed_spread = 0.1\nassumed_because = "So."')
        self.assertEqual(verdict.kind, "reproduced")
        self.assertEqual(verdict.numbers, "3.00 [2.45, 3.67] (room); interval assumed: 10 %")

    def test_what_is_missing_names_the_command(self):
        empty = Device(None, "D", {})
        self.assertEqual(claims.judge(claim_of(), empty).text,
                         "cannot be judged here: no table toggles; experiments/toggles.py makes it")
        self.assertIn("experiments/compare_builds.py --label spills makes it",
                      claims.judge(claim_of('table = "compare_builds-spills"'), empty).text)
        self.assertIn("experiments/x.py A B makes it",
                      claims.judge(claim_of('command = "experiments/x.py A B"'), empty).text)
        self.assertIn("quick tables are not judged", self.kind(pair("room", 3), quick=True).text)
        lacking = claim_of(rule="", lacks={"what": "wings", "takes": "feathers"})
        self.assertEqual(claims.judge(lacking, empty).text,
                         "cannot be judged here: ptexp lacks wings")

    def test_refused_rows_and_other_rows_do_not_count(self):
        rows = pair("room", 3) + [{**row("room", "B", 0.1, 0.1, 0.1), "status": "failed"},
                                  row("room", "C", 1, 1, 1)]
        self.assertEqual(self.kind(rows).numbers, "3.00 [2.94, 3.06] (room)")
        # Of several rows the fastest is compared.
        self.assertEqual(self.kind(rows, 'numerator = { x = ["B", "C"] }').kind, "refuted")
        self.assertEqual(self.kind(rows, 'numerator = { x = "?" }\nvary = { way = "x" }').text,
                         "holds only when way is B (1 of 3 cases)")
        # A bracket is a letter.
        self.assertEqual(self.kind(rows, 'numerator = { x = "[B]" }').kind, "cannot be judged here")

    def test_repeats_give_an_interval_by_bootstrap(self):
        runs = {"A": [1.0, 1.1, 0.9, 1.0], "B": [3.0, 3.3, 2.7, 3.1]}
        rows = [row("room", name, min(times), intervals.median(times), max(times), rounds=2,
                    kernel_ms_runs=";".join(map(str, times))) for name, times in runs.items()]
        cell, = self.kind(rows).cells
        top, bottom = ([times[:2], times[2:]] for times in (runs["B"], runs["A"]))
        self.assertEqual((cell.value.low, cell.value.high), intervals.bootstrap(
            [top, bottom], lambda s: intervals.median(s[0]) / intervals.median(s[1])))
        conservative, = self.kind([{**one, "rounds": ""} for one in rows]).cells
        self.assertEqual((conservative.value.low, conservative.value.high), (2.7 / 1.1, 3.3 / 0.9))

    def test_other_statistics(self):
        line = [row("room", str(x), 0.99 * y, y, 1.01 * y, rays=rays)
                for x, y, rays in ((1, 1, 10), (4, 16, 160), (16, 256, 2560))]
        cell, = self.kind(line, 'statistic = "exponent"\nalong = "x"').cells
        self.assertAlmostEqual(cell.value.middle, 2)
        self.assertLess(cell.value.low, 2)
        self.assertGreater(cell.value.high, 2)
        first, second = self.kind(line[::-1], 'statistic = "steps"\nalong = "x"').cells
        self.assertEqual([(cell.labels["step"], cell.value.middle) for cell in (first, second)],
                         [("1 to 4", 16), ("4 to 16", 16)])
        per_ray = self.kind(line, 'statistic = "steps"\nalong = "x"\nper = "rays"').cells
        self.assertEqual([cell.value.middle for cell in per_ray], [1, 1])
        last, = self.kind(line, 'statistic = "value"\nlast_of = "x"\ntimes = "rays"').cells
        self.assertAlmostEqual(last.value.middle, 256 * 2560)
        with self.assertRaisesRegex(claim_files.ClaimError, "planted.toml.*3 rows for room"):
            self.kind(line, 'statistic = "value"')
        mixed = [line[0], {**line[1], "status": "refused", "kernel_ms_median": ""}]
        ran = self.kind(mixed, 'statistic = "measured"\nfor_each = { size = "x" }\nat_most = 0\n'
                        "at_least = 0")
        self.assertEqual((ran.text, ran.numbers),
                         ("holds only when size is 4 (1 of 2 cases)", "1 of 2 cases ran"))

    def test_when_is_said_shortly(self):
        def said(holding, failing, words):
            cells = [[Cell(dict(zip(words, key.split("/"))), None, ()) for key in keys]
                     for keys in (holding.split(), failing.split())]
            return claims.condition(*cells)
        for holding, failing, text in (
                ("a/1 a/2 b/1 b/2", "c/1", "p is not c (4 of 5 cases)"),
                ("a/1 b/1", "a/2 b/2", "q is 1 (2 of 4 cases)"),
                ("a/1", "a/2 b/1 b/2", "p is a and q is 1 (1 of 4 cases)"),
                ("a/1 a/2 b/1", "b/2 c/1", "p is a, or b (q is 1) (3 of 5 cases)")):
            self.assertEqual(said(holding, failing, "pq"), text)
        many = " ".join(f"case{number:040}" for number in range(20))
        self.assertRegex(said(many, "none1 " + " ".join(f"no{n}" for n in range(30)), "p"),
                         r"^case0+; case0+1; case0+2; case0+3; and others \(20 of 51 cases\)$")


class Paper(unittest.TestCase):
    """The student paper's seven, on tables whose numbers are known."""

    def judged(self, **tables):
        with tempfile.TemporaryDirectory() as name:
            for table, rows in tables.items():
                planted.write(Path(name) / "d", table, rows, planted.facts(table, None))
            found = claims.judge_all(read_device(Path(name) / "d"))
        return {claim.name[6:]: verdict for claim, verdict in found if claim.name.startswith("paper_")}

    def kinds(self, **tables):
        return {name: verdict.kind for name, verdict in self.judged(**tables).items()}

    def sizes(self, cpu, power=1.0):
        return [{**one, "repeat": 10} for one in planted.sizes(cpu, power)]

    def test_each_has_a_verdict(self):
        unjudged = "cannot be judged here"
        self.assertEqual(
            self.kinds(toggles=planted.toggles(), image_size=self.sizes(1000),
                       block_size=planted.blocks((4, 3, 2, 1)), sampling=planted.sampling(4, 2),
                       scene_memory=planted.places()),
            {"growth": "refuted", "larger_blocks": "refuted", "shared_memory": "refuted",
             "reduced_branching": "refuted", "gpu_over_cpu": "reproduced",
             "importance_sampling": "reproduced", "metropolis": unjudged})
        self.assertEqual(
            self.kinds(toggles=planted.toggles((0.4, 0.5, 0.6)), image_size=self.sizes(2, power=4),
                       block_size=planted.blocks((1, 2, 3, 4)), sampling=planted.sampling(2, 4)),
            {"growth": "reproduced", "larger_blocks": "reproduced", "shared_memory": unjudged,
             "reduced_branching": "reproduced", "gpu_over_cpu": "refuted",
             "importance_sampling": "refuted", "metropolis": unjudged})
        mixed = self.judged(block_size=planted.blocks((4, 2, 3, 2.99)))["larger_blocks"].text
        self.assertEqual(mixed, "holds only when step is 64 to 256 (1 of 3 cases)")
        self.assertEqual(set(self.kinds(toggles=planted.toggles()[:1]).values()), {unjudged})

    def test_nothing_is_decided_without_significance(self):
        wide = [{**one, "kernel_ms_min": 0.1, "kernel_ms_max": 9} for one in planted.blocks((1, 2, 3, 4))]
        self.assertEqual(self.kinds(block_size=wide)["larger_blocks"], "cannot be judged here")
        # Half of the default's time, by an interval that has the default in it.
        self.assertEqual(self.kinds(toggles=planted.toggles((0.3, 0.5, 1.5)))["reduced_branching"],
                         "cannot be judged here")

    def test_metropolis_is_judged_at_equal_samples(self):
        for gains, kind in (((8, 8), "reproduced"), ((8, 0.2), "holds only when"), ((0.2, 0.2), "refuted"),
                            ((8, 2), "holds only when"), ((2, 2), "cannot be judged here")):
            rows = planted.metropolis(*(
                (f"s{i}", {0.1: (0.1, 0.2, 0.3), 0.5: (0.9 * gain, gain, 1.1 * gain)})
                for i, gain in enumerate(gains)))
            # A time takes 100 paths or 200 mutations: half of the gain is left, and 2 is none.
            self.assertEqual(self.kinds(metropolis=rows)["metropolis"], kind, gains)
        alone = [one for one in planted.metropolis(("room", {0.5: (7, 8, 9)})) if one["series"] == "path"]
        self.assertEqual(self.kinds(metropolis=alone)["metropolis"], "cannot be judged here")


class Committed(unittest.TestCase):
    def test_all_are_judged_on_each_device_and_its_page_says_so(self):
        self.assertGreaterEqual(len(DEVICES), 4)
        pages = 0
        for folder in DEVICES:
            judged = claims.judge_all(read_device(folder))
            self.assertEqual(len(judged), len(list(claim_files.CLAIMS.glob("*.toml"))))
            self.assertTrue({verdict.kind for _, verdict in judged} <=
                            {"reproduced", "refuted", "holds only when", "cannot be judged here"})
            page = folder / "report.html"
            if not page.is_file():
                continue
            pages += 1
            text = page.read_text(encoding="utf-8")
            section = text[text.index('<section id="claims">'):].partition("</section>")[0]
            said = [unescape(one) for one in re.findall(r'<span class="verdict \w+">(.*?)</span>', section)]
            self.assertEqual(said, [verdict.text for _, verdict in judged],
                             f"{folder.name}: run scripts/report and commit the page")
            for claim, verdict in judged:
                for part in (claim.claim, claim.citation, verdict.numbers, verdict.commit,
                             claim.lacks.get("takes", "")):
                    self.assertIn(part, unescape(section), claim.name)
        self.assertGreaterEqual(pages, 4)

    def test_every_kind_of_verdict_and_its_commit(self):
        judged = claims.judge_all(read_device(planted.RESULTS))
        self.assertEqual(len({verdict.kind for _, verdict in judged}), 4)
        for claim, verdict in judged:
            if verdict.cells:
                self.assertRegex(verdict.commit, r"^\w{7}", claim.name)
                self.assertTrue(verdict.numbers, claim.name)

    def test_the_program_and_the_site_say_the_same(self):
        said = subprocess.run([sys.executable, ROOT / "scripts" / "claims"], check=True, text=True,
                              capture_output=True).stdout
        page = markdown(read_device(planted.RESULTS))
        for claim, verdict in claims.judge_all(read_device(planted.RESULTS)):
            self.assertIn(f"\n{claim.name}: {verdict.text}\n", f"\n{said}")
            self.assertIn(f" | {verdict.text} | ", page)


if __name__ == "__main__":
    unittest.main()
