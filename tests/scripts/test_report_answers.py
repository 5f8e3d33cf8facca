"""The first screen and the table of scenes of scripts/report: one verdict for each work, by planted
tables and on the committed pages."""
import html
import re
import shutil
import sys
import tempfile
import unittest
from dataclasses import dataclass
from html.parser import HTMLParser
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))
from test_report import ROOT, TOGGLES, facts, toggle, write  # noqa: E402
from report_parts import first, modes, words  # noqa: E402
from report_parts.page import page  # noqa: E402
from report_parts.tables import Interval, read_device  # noqa: E402

PAGES = sorted((ROOT / "results").glob("*/report.html"))
FAR = 1.02  # medians of one program differ by less from run to run


@dataclass
class Said:
    """What a cell or a point of a page says of a work."""
    work: str
    how: str
    mode: str
    word: str
    middle: float
    low: float
    high: float


class Reader(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.said = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        if "data-work" in values:
            middle = float(values.get("data-v") or values["data-middle"])
            self.said.append(Said(*(values.get(f"data-{name}", "") for name in (
                "work", "how", "mode", "word")), middle, *(float(values.get(f"data-{end}", middle))
                                                          for end in ("low", "high"))))

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)


def apart(one, other):
    return ((one.low > other.high or other.low > one.high)
            and max(one.middle / other.middle, other.middle / one.middle) > FAR)


def scene_rows(text):
    section = text[text.index('<section id="by-scene">'):text.index('<section id="causes">')]
    return re.findall(r"<tr><th scope=\"row\">.*?</tr>", section, re.S)


def contradictions(text):
    """Pairs of values of the same work and options that are apart, or judged by other words; scenes
    that the table has twice; and times that are better than the `best` of the table of scenes."""
    groups, found = {}, []
    for one in Reader(text).said:
        groups.setdefault((one.work, one.how), []).append(one)
    for key, group in groups.items():
        found += [(key, group[0], other) for other in group[1:]
                  if apart(group[0], other) or group[0].word != other.word]
    rows = scene_rows(text)
    names = [re.match(r'<tr><th scope="row">([^<]*)', row)[1] for row in rows]
    found += [("twice", name) for name in set(names) if names.count(name) > 1]
    for row in rows:
        for best in Reader(row).said:
            found += [("better", best, other) for group in groups.values() for other in group
                      if (other.work, other.mode) == (best.work, best.mode) and best.mode
                      and other.middle < best.middle and apart(best, other)]
    return found


def cell(experiment, scene, mode, ms, size=1024, depth=8, spread=0.005, **more):
    return {**toggle(scene, mode, (1 - spread) * ms, ms, (1 + spread) * ms),
            "experiment": experiment, "name": f"{scene} {size} {depth} {mode}", "scene": scene,
            "mode": mode, "width": size, "height": size, "spp": 16, "max_depth": depth,
            "device_name": "Device A", **more}


def defaults(**scenes):
    """Scenes with (megakernel ms, wavefront ms)."""
    return [cell("defaults", scene, mode, ms) for scene, times in scenes.items()
            for mode, ms in zip(modes.MODES, times)]


class Answers(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="ptexp answers ")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name) / "device-a"

    def plant(self, name, rows, day=2, **more):
        plot = {"scaling": None}.get(name, TOGGLES)
        write(self.folder, name, rows, facts(more.pop("experiment", name), plot,
                                             date=f"2026-01-{day:02}T03:04:05+00:00", **more))

    def page(self):
        return page([read_device(self.folder)], 0)

    def rows(self, text):
        return [re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", re.sub("</?span[^>]*>", "", row))
                for row in scene_rows(text)]

    def test_words_of_nvbench(self):
        one = Interval(1, 0.99, 1.01)
        for other, word in ((Interval(2, 1.9, 2.1), "slower"), (Interval(0.5, 0.4, 0.6), "faster"),
                            (Interval(1.015, 1.0, 1.03), "same"), (Interval(1.05, 1.0, 1.1),
                                                                   "ambiguous"),
                            (Interval(2), "ambiguous")):
            self.assertEqual(words.change(one, other)[0], word)

    def test_a_row_for_each_scene(self):
        self.plant("defaults", defaults(room=(4, 2), box=(1, 2), near=(2, 2.01)) + [
            cell("defaults", "box", mode, ms, size=64) for mode, ms in (("megakernel", 0.2),
                                                                       ("wavefront", 0.1))]
                   + [cell("defaults", "alone", "megakernel", 1),
                      cell("defaults", "room", "megakernel", 9, kernel="loop")])
        rows = self.rows(self.page())
        self.assertEqual([(row[0], row[1], row[6].split(" ")[0], row[7]) for row in rows],
                         [("box", "1024x1024", "0.500", "slower"), ("near", "1024x1024", "0.995",
                                                                    "same"),
                          ("room", "1024x1024", "2.00", "faster")])
        self.assertEqual(rows[2][4], "4.00 [3.98, 4.02]")
        self.assertEqual({row[8] for row in rows}, {"not measured"})

    def test_the_newest_complete_table_speaks(self):
        self.plant("defaults", defaults(room=(4, 2)), day=2)
        self.plant("scenes", defaults(room=(5, 2), hall=(1, 3)), day=1)
        text = self.page()
        self.assertEqual([row[0] for row in self.rows(text)], ["room"])
        self.assertRegex(text, r"scenes\.csv, 4 rows.*?</a>: disagrees with defaults")
        self.assertNotIn('class="experiment" id="scenes"', text)
        self.assertEqual(contradictions(text), [])
        # The other one is newer, and says the same but for the drift of runs.
        self.plant("scenes", defaults(room=(4.05, 2), hall=(1, 3)), day=3)
        self.assertEqual([row[0] for row in self.rows(self.page())], ["hall", "room"])
        # Cut off, it does not speak where there is a complete one of its experiment.
        self.plant("scenes", defaults(room=(9, 2)), day=3, complete=False, experiment="defaults")
        self.assertEqual(self.rows(self.page())[0][4], "4.00 [3.98, 4.02]")
        self.assertIn("</a>: cut off; defaults is complete", self.page())
        self.plant("scenes", defaults(hall=(9, 2)), day=3)
        self.plant("defaults", defaults(room=(9, 2)), day=3 + modes.MOST_DAYS + 2)
        self.assertIn("measured 5 days before defaults", self.page())

    def test_contradictions_of_a_page_are_found(self):
        self.plant("defaults", defaults(room=(4, 2)))
        self.plant("toggles", defaults(room=(4, 2)), day=1)
        text = self.page()
        self.assertEqual(contradictions(text), [])
        self.assertEqual(len([one for one in Reader(text).said if one.work.startswith("room")]), 6)
        # Another table with the same work, as a second verdict would have it.
        other = page([self.other(room=(5, 2))], 0)
        table = re.search(r'<section class="experiment" id="toggles">.*?</section>', other, re.S)[0]
        self.assertTrue(contradictions(text.replace("</main>", table + "</main>")))
        row = scene_rows(text)[0]
        self.assertTrue(contradictions(text.replace(row, row + row)))
        self.assertTrue(contradictions(text.replace('data-word="faster"', 'data-word="same"', 1)))
        better = row.replace('data-v="4"', 'data-v="8"').replace(
            '"3.98"', '"7.98"').replace('"4.02', '"8.02').replace('data-how="', 'data-how="x')
        self.assertTrue(contradictions(text.replace(row, better)))

    def other(self, **scenes):
        folder = self.folder.parent / "other"
        write(folder, "toggles", defaults(**scenes), facts("toggles", TOGGLES))
        return read_device(folder)

    def test_the_answer_is_made_from_the_tables(self):
        grid = [cell("sizes", scene, variant, ms * factor, size, depth, variant=variant,
                     used_mode=used if variant == "auto" else variant)
                for scene, mega, wave, used in (("room", 4, 2, "wavefront"), ("box", 1, 2, "wavefront"))
                for size in (64, 128) for depth in (4, 50)
                for variant, ms, factor in (("megakernel", mega, 2 if depth == 50 else 1),
                                            ("wavefront", wave, 1), ("auto", wave, 1))]
        for row in grid:
            row["mode"] = row["variant"]
        self.plant("sizes", grid)
        said = first.answer_text(read_device(self.folder))
        # Depth 50 doubles the megakernel's time: ratios of box 0.5 and 1, of room 2 and 4.
        self.assertIn("Of 2 scenes, the wavefront is faster in 1 (up to 4.00 times, room) and same in 1",
                      said)
        self.assertIn("of 8 images, auto took the slower mode in 2 and lost at most 100.0\u00a0%", said)
        self.assertIn("always the wavefront would lose 25.0\u00a0% on average, always the megakernel "
                      "100.0\u00a0%", said)
        self.assertIn("Depth 50 instead of 4 multiplies the ratio megakernel / wavefront by 2.00 and 128x128 "
                      "pixels instead of 64x64 by 1.00 (geometric means).", said)
        self.assertEqual({row[0]: row[8] for row in self.rows(self.page())}, {
            "box": "wavefront 4; loses 100.0\u00a0%",
            "room": "wavefront 4"})
        shutil.rmtree(self.folder)
        self.plant("toggles", [toggle("megakernel", "default", 1, 2, 3)])
        self.assertIn("This was not measured", self.page())

    def test_the_answer_is_short(self):
        long = {f"a scene with a name of {n} words that never ends, and ends": (1, 2)
                for n in range(first.MOST_NAMES)}
        self.plant("defaults", defaults(room=(4, 2), **long))
        said = first.answer_text(read_device(self.folder))
        self.assertLessEqual(len(said.split()), 120)
        self.assertIn("Of 6 scenes", said)
        for path in PAGES:
            answer = re.search('<p class="answer-text">(.*?)</p>', path.read_text(encoding="utf-8"))[1]
            self.assertLessEqual(len(html.unescape(re.sub("<.*?>", "", answer)).split()), 120, path)

    def test_committed_pages_have_no_contradictions(self):
        for path in PAGES:
            self.assertEqual(contradictions(path.read_text(encoding="utf-8")), [], path)
        said = Reader((ROOT / "results/nvidia-h200/report.html").read_text(encoding="utf-8")).said
        self.assertGreater(len({one.work for one in said}), 40)


if __name__ == "__main__":
    unittest.main()
