"""The measured numbers of README.md, results/README.md and of the reports' first sections are those of
the tables in results/."""
import csv
import html
import json
import re
import subprocess
import sys
import tempfile
import unittest
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_loader
from statistics import geometric_mean, mean
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RESULTS = ROOT / "results" / "nvidia-h200"

SCRIPTS = ROOT / "scripts"
sys.dont_write_bytecode = True
sys.path.insert(0, str(SCRIPTS))
import page_number_list as listed  # noqa: E402
LOADER = SourceFileLoader("page_numbers", str(SCRIPTS / "page_numbers"))
page_numbers = module_from_spec(spec_from_loader("page_numbers", LOADER))
LOADER.exec_module(page_numbers)

# Numbers that a page may not have unless a Place covers them: fractions, thousands, and with units.
MEASURED = r"\d[\d,]*\.\d+|\d{1,3}(?:,\d{3})+|\d+ (?:ms|s|%|times|million paths a second)(?!\w)"
# Others' numbers, versions, and conditions of the experiments
EXEMPT = {listed.MAIN: ["Ubuntu 24.04", "CC BY 3.0", "by/3.0"],
          listed.TABLES: ["3.9.1", "12,987", "4,705", "11,061", "4,054", "8,765", "1,512",
                          "0.07, 0.07 and 0.00 %", "CC-BY 3.0", "within 10 %"]}
# The commit by which scripts/reproduce made all tables of RESULTS, its first seven digits or more;
# empty: they are of several commits yet.
COMMIT_OF_TABLES = "541c7e6d5fc0"


class PageNumbers(unittest.TestCase):
    def setUp(self):
        self.texts = {page: (ROOT / page).read_text(encoding="utf-8")
                      for page in [*EXEMPT, *(place.page for place in listed.PLACES)]}

    def test_numbers_are_those_of_the_tables(self):
        for page, text in self.texts.items():
            for start, end, value in page_numbers.slots_of(text, page):
                self.assertEqual(text[start:end], value, f"{page}: {text[max(start - 60, 0):end]}")

    def test_sentences_are_true_by_the_tables(self):
        self.assertEqual(list(page_numbers.wrong_claims(self.texts)), [])

    def test_every_measured_number_is_listed(self):
        for page in EXEMPT:
            text = self.texts[page]
            covered = [(start, end) for start, end, _ in page_numbers.slots_of(text, page)]
            covered += [found.span() for one in EXEMPT[page]
                        for found in re.finditer(page_numbers.spaced(one), text)]
            found = [text[max(0, one.start() - 30):one.end()] for one in re.finditer(MEASURED, text)
                     if not any(start < one.end() and one.start() < end for start, end in covered)]
            self.assertEqual(found, [], page)

    def test_a_changed_table_changes_the_page(self):
        page = listed.MAIN
        text = self.texts[page]
        places = [listed.Place(page, "the megakernel takes {:.1f} ms, the plain", [lambda: 7.25])]
        slots = page_numbers.slots_of(text, page, places)
        changed = page_numbers.rewritten(text, slots)
        self.assertIn("7.2 ms, the plain wavefront", re.sub(r"\s+", " ", changed))
        self.assertEqual(len(changed.splitlines()), len(text.splitlines()))
        for wrong in ("no such sentence {:.1f} ms", "the wavefront {}"):
            with self.assertRaises(listed.NumberError):
                page_numbers.slots_of(text, page, [listed.Place(page, wrong, [lambda: 1])])
        errors = []  # a place without its row keeps no other from being written
        lacking = listed.Place(page, "the full one {:.1f} ms", [listed.cell("ladder", "nothing")])
        self.assertEqual(page_numbers.slots_of(text, page, [lacking, *places], errors), slots)
        self.assertIn("ladder.csv has 0 rows with {'name': 'nothing'}", errors[0])

    def test_a_sentence_that_the_tables_contradict_is_found(self):
        said = listed.Claim(listed.MAIN, "On a million triangles the wavefront is faster", lambda: False)
        gone = listed.Claim(listed.MAIN, "On a million triangles the megakernel is faster", lambda: True)
        self.assertEqual([line.split(": ")[0] for line in page_numbers.wrong_claims(self.texts, [said, gone])],
                         ["README.md", "README.md has no more"])

    def test_the_size_of_the_ladders_spheres(self):
        row = listed.row_of("ladder", name="spheres: 0 megakernel")
        self.assertIn("spheres at {width}x{height}, {spp} samples".format(**row),
                      re.sub(r"\s+", " ", self.texts[listed.MAIN]))

    def test_the_paper_is_named(self):
        for name in ("README.md", "CITATION.cff"):
            self.assertIn("Parallel Path Tracing with CUDA",
                          (ROOT / name).read_text(encoding="utf-8"), name)


def steps_of_reproduce():
    """Those that one GPU can do."""
    done = subprocess.run([sys.executable, SCRIPTS / "reproduce", "--list"], capture_output=True, text=True,
                          check=True)
    return {line.split()[0] for line in done.stdout.splitlines()[:-1]} - {"scaling"}


def not_of_the_run(folder, steps, commit):
    """What keeps the tables of a folder from being one run of the program of the commit."""
    found = {path.stem for path in folder.glob("*.csv")}
    wrong = [f"{name}: {text}" for names, text in (
        (steps - found, "missing"), (found - steps, "no step makes it")) for name in sorted(names)]
    for name in sorted(found & steps):
        facts = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
        said = next(line.split()[1] for line in facts["program"] if line.startswith("commit "))
        with open(folder / f"{name}.csv", newline="", encoding="utf-8") as file:
            of_rows = {row["commit"] for row in csv.DictReader(file) if row.get("commit")}
        of_tables = {one["commit"] for one in facts.get("tables", {}).values()}  # what the law was made of
        others = {one for one in {said} | of_rows | of_tables if not one.startswith(commit) or one.endswith("-dirty")}
        wrong += [f"{name}: commit {', '.join(sorted(others))}"] if others else []
        if facts.get("complete") is not True or facts.get("quick"):
            wrong.append(f"{name}: incomplete or of --quick")
    return wrong


class OneRun(unittest.TestCase):
    def test_tables_are_of_one_commit(self):
        if not COMMIT_OF_TABLES:
            self.skipTest("the tables of several commits are to be replaced by one run")
        self.assertEqual(not_of_the_run(RESULTS, steps_of_reproduce(), COMMIT_OF_TABLES), [])

    def test_a_table_of_another_commit_is_found(self):
        with tempfile.TemporaryDirectory(prefix="ptexp one run ") as name:
            folder = Path(name)
            for table, commit, complete in (("a", "abcdef012345", True), ("b", "abcdef012345-dirty", True),
                                            ("c", "abcdef012345", False), ("e", "abcdef012345", True)):
                (folder / f"{table}.csv").write_text(f"name,commit\nx,{commit}\n", encoding="utf-8")
                (folder / f"{table}.json").write_text(json.dumps({
                    "program": ["ptexp 1", f"commit {commit}"], "complete": complete}), encoding="utf-8")
            (folder / "a.csv").write_text("name,commit\nx,abcdef012345\ny,\n", encoding="utf-8")
            self.assertEqual(not_of_the_run(folder, {"a", "b", "c", "d"}, "abcdef0"), [
                "d: missing", "e: no step makes it", "b: commit abcdef012345-dirty",
                "c: incomplete or of --quick"])
            facts = json.loads((folder / "a.json").read_text(encoding="utf-8"))
            (folder / "a.json").write_text(json.dumps({**facts, "tables": {"b": {"commit": "fedcba9"}}}),
                                           encoding="utf-8")
            self.assertIn("a: commit fedcba9", not_of_the_run(folder, {"a"}, "abcdef0"))
            (folder / "a.json").write_text(json.dumps(facts), encoding="utf-8")
            (folder / "a.csv").write_text("name,commit\nx,0123456\n", encoding="utf-8")
            self.assertIn("a: commit 0123456", not_of_the_run(folder, {"a"}, "abcdef0"))


def times_of(folder, table):
    """{(scene, size, samples, depth): {mode: (kernel_ms, used mode)}}: the fastest of each mode."""
    times = {}
    with open(folder / f"{table}.csv", newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["status"] == "measured":
                work = ("/".join(row["scene"].split("/")[-2:]), f"{row['width']}x{row['height']}",
                        row["spp"], row["max_depth"])
                mode = row["variant"] if row.get("variant") == "auto" else row["mode"]
                value = float(row["kernel_ms_median"]), row.get("used_mode", "")
                times.setdefault(work, {}).setdefault(mode, value)
                times[work][mode] = min(times[work][mode], value)
    return times


def cells_of(row):
    return [(html.unescape(re.sub("<.*?>", "", text)), re.search(r'data-v="([^"]*)"', attributes))
            for attributes, text in re.findall(r"<t[dh]([^>]*)>(.*?)</t[dh]>", row)]


class ReportNumbers(unittest.TestCase):
    def check_page(self, path):
        text = path.read_text(encoding="utf-8")
        answer = html.unescape(re.sub("<.*?>", "", re.search('"answer-text">(.*?)</p>', text)[1]))
        ratios, grid = [], {}
        section = text.partition('id="by-scene"')[2].partition('id="causes"')[0]
        for row in re.findall(r'<tr><th scope="row">.*?</tr>', section):
            cells = cells_of(row)
            times = times_of(path.parent, cells[9][0])
            grid |= {work: modes for work, modes in times.items() if "auto" in modes}
            modes = times[tuple(cell for cell, _ in cells[:4])]
            mega, wave = (modes[mode][0] for mode in ("megakernel", "wavefront"))
            self.assertEqual([float(cell[1][1]) for cell in cells[4:7]], [mega, wave, mega / wave])
            ratios.append((mega / wave, cells[7][0]))
        expected = [str(len(ratios))] if ratios else []
        for word in ("faster", "slower"):
            mine = [max(ratio, 1 / ratio) for ratio, said in ratios if said == word]
            expected += [str(len(mine)), f"{max(mine):.2f}"] if mine else []
        for word in ("same", "ambiguous"):
            count = sum(said == word for _, said in ratios)
            expected += [str(count)] if count else []
        expected += self.numbers_of_grid(grid) if grid else []
        without_names = re.sub(r"\b[\w-]+:[\w:-]+", "", answer)
        self.assertEqual(re.findall(r"\d+(?:\.\d+)?(?:x\d+)?", without_names), expected, path)

    def numbers_of_grid(self, grid):
        best = {work: min(modes["megakernel"][0], modes["wavefront"][0]) for work, modes in grid.items()}
        losses = {mode: [modes[modes["auto"][1] if mode == "auto" else mode][0] / best[work] - 1
                         for work, modes in grid.items()] for mode in ("auto", "wavefront", "megakernel")}
        found = [str(len(grid)), str(sum(loss > 0 for loss in losses["auto"])),
                 *(f"{100 * value:.1f}" for value in (max(losses["auto"]), mean(losses["wavefront"]),
                                                      mean(losses["megakernel"])))]
        for place, key in ((3, int), (1, lambda size: int(size.split("x")[0]))):
            ends = [end((work[place] for work in grid), key=key) for end in (min, max)]
            ratio = {work: modes["megakernel"][0] / modes["wavefront"][0] for work, modes in grid.items()}
            means = [geometric_mean(value for work, value in ratio.items() if work[place] == end)
                     for end in ends]
            found += [ends[1], ends[0], f"{means[1] / means[0]:.3f}"]
        return found

    def test_first_sections(self):
        pages = sorted((ROOT / "results").glob("*/report.html"))
        self.assertGreaterEqual(len(pages), 4)
        for path in pages:
            self.check_page(path)

    def test_the_frame_has_no_numbers(self):
        frame = (ROOT / "scripts" / "report_parts" / "page.html").read_text(encoding="utf-8")
        self.assertNotRegex(re.sub("<.*?>", "", frame), r"\d")


if __name__ == "__main__":
    unittest.main()
