"""The measured numbers of README.md and of the reports' first sections are those of the tables in
results/."""
import csv
import html
import re
import unittest
from statistics import geometric_mean, mean
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RESULTS = ROOT / "results" / "nvidia-h200"

PAPER, STATUE = "spheres 600x300", "statue:1M 1024x1024"
# What README.md says, with the number's place and format; table, row and column of the number, and
# what the column is multiplied with.
NUMBERS = [
    ("takes the megakernel {:.1f} ms", "defaults", f"{PAPER}: megakernel", "kernel_ms_median", 1),
    ("the wavefront {:.1f} ms", "defaults", f"{PAPER}: wavefront", "kernel_ms_median", 1),
    ("one CPU thread {:.0f} s", "image_size", "serial, CPU 2400x1200", "image_ms_median", 1e-3),
    ("the megakernel {:.0f} ms, and one", "image_size", "megakernel, CUDA 2400x1200", "image_ms_median", 1),
    ("{:.0f} million paths a second in the megakernel", "defaults",
     f"{STATUE}: megakernel", "mpaths_per_s", 1),
    ("{:.0f} million paths a second in the wavefront", "defaults", f"{STATUE}: wavefront",
     "mpaths_per_s", 1),
    *[(text, "ladder", f"{scene}: {step}", "kernel_ms_median", 1) for text, scene, step in [
        ("16 materials takes {:.1f} ms in the plain", "dial:16:0:closed", "1 megakernel"),
        ("{:.1f} ms in the block-local wavefront", "dial:16:0:closed", "0 megakernel at its best"),
        ("{:.1f} ms in a plain wavefront", "dial:16:0:closed", "2 split kernels"),
        ("{:.1f} ms in one with all its steps", "dial:16:0:closed", "12 persistent warps"),
        ("spheres at 1200x600, 50 samples, the megakernel takes {:.1f} ms", "spheres", "0 megakernel"),
        ("the plain wavefront {:.1f} ms and", "spheres", "1 split kernels"),
        ("and the full one {:.1f} ms.", "spheres", "11 two rays a wave")]],
]
MEASURED = r"[\d.,]+ (?:ms|s|million paths a second)\b"  # what README.md may not say unless listed


def text_of(table, name, column):
    with open(RESULTS / f"{table}.csv", newline="", encoding="utf-8") as file:
        row, = (row for row in csv.DictReader(file) if row["name"] == name)
    return row[column]


def number(*cell):
    return float(text_of(*cell))


class ReadmeNumbers(unittest.TestCase):
    def setUp(self):
        text = (ROOT / "README.md").read_text(encoding="utf-8")
        self.text = re.sub(r"\s+", " ", text)
        self.expected = [text.format(number(*cell) * factor) for text, *cell, factor in NUMBERS]

    def test_numbers_are_those_of_the_tables(self):
        for expected, (_, *cell, _) in zip(self.expected, NUMBERS):
            self.assertIn(expected, self.text, f"README.md, by {' | '.join(cell)}")

    def test_every_measured_number_is_listed(self):
        listed = {found for text in self.expected for found in re.findall(MEASURED, text)}
        self.assertEqual(set(re.findall(MEASURED, self.text)), listed)

    def test_what_is_extrapolated_says_so(self):
        name = "serial, CPU 2400x1200"
        if text_of("image_size", name, "extrapolated") == "yes":
            self.assertRegex(self.text, r"one CPU thread \d+ s: extrapolated from a tenth of the")
            share = [int(text_of("image_size", name, column)) for column in ("spp", "full_spp")]
            self.assertEqual(10 * share[0], share[1])

    def test_the_size_of_the_ladders_spheres(self):
        sizes = [text_of("ladder", "spheres: 0 megakernel", column)
                 for column in ("width", "height", "spp")]
        self.assertIn("spheres at {}x{}, {} samples".format(*sizes), self.text)

    def test_the_paper_is_named(self):
        for name in ("README.md", "CITATION.cff"):
            self.assertIn("Parallel Path Tracing with CUDA",
                          (ROOT / name).read_text(encoding="utf-8"), name)


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
