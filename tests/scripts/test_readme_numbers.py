"""README.md's measured numbers are those of the tables in results/."""
import csv
import re
import unittest
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


if __name__ == "__main__":
    unittest.main()
