"""scripts/report on small tables whose numbers are known: what the page says, and what it draws."""
import csv
import json
import math
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree
from html.parser import HTMLParser
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
REPORT = ROOT / "scripts" / "report"
RESULTS = ROOT / "results" / "nvidia-h200"
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "scripts"))
from report_parts import answers, verdicts, words  # noqa: E402
from report_parts.axes import Scale, domain  # noqa: E402
from report_parts.plot_lines import scale_over  # noqa: E402
from report_parts.scaling import against_prediction  # noqa: E402
from report_parts.tables import Device, Interval, Table, interval, read_device, read_table  # noqa: E402

VOID = {"meta", "img", "input", "br", "link", "hr"}
# A PNG of one pixel.
PIXEL = bytes.fromhex("89504e470d0a1a0a0000000d49484452000000010000000108060000001f15c4890000000d"
                      "49444154789c6360606060000000050001a5f645400000000049454e44ae426082")
TOGGLES = {"kind": "bars", "title": "Toggles", "x_label": "", "y_label": "kernel time [ms]",
           "y": "kernel_ms", "log_y": False}
SIZES = {"kind": "lines", "title": "Sizes", "x_label": "pixels", "y_label": "time [ms]",
         "y": "image_ms", "log_y": True}


def facts(name, plot, **more):
    return {"experiment": name, "question": f"{name.capitalize()}: how long does it take?",
            "command": f"python3 {name}.py", "date": "2026-01-02T03:04:05+00:00", "quick": False,
            "program": ["ptexp 0.1.0", "commit abc"], "gpus": ["name, driver_version", "G, 1.2"],
            "device": {"choice": "cuda:0", "name": "Device A", "detail": "2 units"},
            "host": {"cpu": "C", "cores": 4, "system": "S"}, "plot": plot, **more}


def write(folder, name, rows, description):
    folder.mkdir(parents=True, exist_ok=True)
    columns = list(dict.fromkeys(column for row in rows for column in row))
    with open(folder / f"{name}.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        writer.writerows(rows)
    if description:
        (folder / f"{name}.json").write_text(json.dumps(description), encoding="utf-8")


def toggle(mode, choice, low, middle, high, **more):
    return {"experiment": "toggles", "name": f"{mode}: {choice}", "status": "measured",
            "message": "", "panel": mode, "x": choice, "schema_version": 6, "commit": "abc",
            "width": 600, "height": 300, "mode": mode, "repeat": 10, "kernel_ms_median": middle,
            "kernel_ms_min": low, "kernel_ms_max": high, "mpaths_per_s": 9000, **more}


def toggles(reduced=(1.9, 2.0, 2.1)):
    return [toggle("megakernel", "default", 0.98, 1.0, 1.02),
            toggle("megakernel", "scene-memory shared", 1.01, 1.03, 1.05),
            toggle("megakernel", "branching reduced", *reduced),
            toggle("megakernel", "rng <odd> & \"new\"", 0.7, 0.75, 0.8)]


def size(series, kind, pixels, low, middle, high, repeat=10):
    width = math.isqrt(2 * pixels)
    return {"experiment": "image_size", "name": f"{series} {pixels}", "status": "measured",
            "series": series, "panel": "", "x": pixels, "image_ms_median": middle,
            "image_ms_min": low, "image_ms_max": high, "schema_version": 1, "commit": "abc",
            "width": width, "height": width // 2, "mode": series.partition(",")[0],
            "repeat": repeat, "device_kind": kind, "kernel_ms_median": middle,
            "kernel_ms_min": low, "kernel_ms_max": high}


def sizes(cpu=1000.0, power=1.0):
    rows = []
    for pixels in (20000, 80000, 320000):
        growth = (pixels / 20000) ** power
        rows += [size("megakernel, CUDA", "cuda", pixels, 0.9 * growth, growth, 1.2 * growth),
                 size("wavefront, CUDA", "cuda", pixels, 1.9 * growth, 2 * growth, 2.1 * growth),
                 size("serial, CPU", "cpu", pixels, cpu * growth, cpu * growth, cpu * growth, 1)]
    return rows


def blocks(times):
    rows = [{"experiment": "block_size", "name": f"{threads}", "status": "measured", "message": "",
             "series": "megakernel, pixel", "panel": "600x300", "x": threads, "schema_version": 1,
             "commit": "abc", "width": 600, "height": 300, "block": f"{side}x{side}",
             "repeat": 10, "kernel_ms_median": time, "kernel_ms_min": 0.99 * time,
             "kernel_ms_max": 1.01 * time}
            for (threads, side), time in zip(((16, 4), (64, 8), (256, 16), (1024, 32)), times)]
    return rows + [{**rows[0], "name": "4096", "x": 4096, "status": "refused",
                    "message": "too many",
                    **{f"kernel_ms_{part}": "" for part in ("median", "min", "max")}}]


def sampling(uniform, ours):
    return [{"experiment": "sampling", "name": way, "status": "measured", "panel": "cornell",
             "series": way, "x": 1.5, "equal": "4 spp", "relmse": error, "gain": 1 / error,
             "schema_version": 6} for way, error in (("sampling uniform, nee off", uniform),
                                                     ("nee off", ours))]


def metropolis(*scenes, samples=200, references="agree"):
    """A table of (scene, {seconds: gain in percent, low, high}); a mutation takes half of a path's
    time where there are twice as many as the 100 paths."""
    rows = []
    for scene, gains in scenes:
        for seconds, (low, middle, high) in gains.items():
            for series, count in (("path", 100), ("mlt", samples)):
                error = 1.0 if series == "path" else 1 / middle
                row = {**toggle(series, 1000 * seconds, 1, 1, 1), "experiment": "metropolis",
                       "name": f"{scene}: {series}, {seconds:g} s", "panel": scene,
                       "series": series, "seconds": f"{seconds:g}", "samples": count, "seeds": 5,
                       "repeat": 1, "references": references,
                       **{f"relmse_{end}": scale * error for end, scale in
                          (("low", 0.9), ("median", 1), ("high", 1.1))},
                       "gain_low": "", "gain_median": "", "gain_high": ""}
                if series == "mlt":
                    row |= {"gain_low": low, "gain_median": middle, "gain_high": high}
                rows.append(row)
        rows.append({**rows[-1], "x": "", "series": "mlt, megakernel", "seeds": "", "samples": "",
                     "gain_median": "", "name": f"{scene}: other"})
    return rows


def places():
    """A table of scene_memory."""
    return [{**toggle("megakernel, brute", "", 0.98 * ms, ms, 1.02 * ms), "series": memory,
             "x": count} for count, times in ((50, (2.0, 1.0)), (1000, (2.0, 2.02)))
            for memory, ms in zip(("global", "shared"), times)]


class Page(HTMLParser):
    """Reads a page and finds tags that do not match, references, ids and the texts of cells."""

    def __init__(self, text):
        super().__init__()
        self.open, self.wrong, self.references, self.ids, self.exact = [], [], [], [], []
        self.tags, self.attributes = set(), set()
        self.feed(text)
        self.close()
        self.wrong += self.open

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        self.tags.add(tag)
        self.attributes |= set(values)
        if tag not in VOID:
            self.open.append(tag)
        self.references += [values[name] for name in ("src", "href", "xlink:href", "srcset",
                                                      "data", "action", "poster")
                            if values.get(name)]
        self.ids += [values["id"]] if "id" in values else []
        self.exact += [values["data-v"]] if "data-v" in values else []

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.wrong.append(f"/{tag} at {self.getpos()}")


def plots_in(text):
    return [ElementTree.fromstring(svg) for svg in re.findall(r"<svg.*?</svg>", text, re.S)]


class Report(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="ptexp report ")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name) / "device-a"

    def run_report(self, *arguments, fails=False):
        done = subprocess.run([sys.executable, str(REPORT), *map(str, arguments)], text=True,
                              capture_output=True, check=False)
        self.assertEqual(done.returncode, 1 if fails else 0, done.stderr)
        return done.stderr if fails else done.stdout

    def make(self, **tables):
        plots = {"toggles": TOGGLES, "image_size": SIZES,
                 "block_size": {**SIZES, "y": "kernel_ms", "x_label": "threads per block"},
                 "sampling": {**SIZES, "y": "relmse"}, "ladder": TOGGLES,
                 "defaults": TOGGLES, "metropolis": {**SIZES, "y": "relmse", "x_label": "time [ms]"},
                 "random_numbers": TOGGLES, "pool_size": SIZES,
                 "scene_memory": {**SIZES, "y": "kernel_ms", "x_label": "spheres"},
                 "growth": {**SIZES, "y": "kernel_ms", "x_label": ""},
                 "sizes": {**SIZES, "y": "kernel_ms", "x_label": "pixels"}}
        for name, rows in tables.items():
            write(self.folder, name, rows, facts(name, plots[name]))
        self.run_report(self.folder)
        return (self.folder / "report.html").read_text(encoding="utf-8")

    def check_well_formed(self, text):
        page = Page(text)
        self.assertEqual(page.wrong, [])
        self.assertEqual(len(page.ids), len(set(page.ids)))
        for reference in page.references:
            self.assertRegex(reference, r"^(#|data:image/png;base64,|[\w-]+\.csv$)")
            if reference.startswith("#"):
                self.assertIn(reference[1:], page.ids)
        self.assertNotRegex(text, r"@import|url\(|https?://")
        return page

    def test_numbers_are_those_of_the_tables(self):
        text = self.make(toggles=toggles(), image_size=sizes())
        exact = Page(text).exact
        points = [float(point.get("data-middle")) for svg in plots_in(text)
                  for point in svg.iter() if (point.get("class") or "").startswith("point")]
        for row, column in ([(row, "kernel_ms") for row in toggles()]
                            + [(row, "image_ms") for row in sizes()]):
            self.assertIn(str(row[f"{column}_median"]), exact)
            if row["repeat"] > 1:
                low, middle, high = (words.show(row[f"{column}_{part}"], 4)
                                     for part in ("min", "median", "max"))
                self.assertIn(f">{middle} [{low}, {high}]</td>", text)
            self.assertIn(row[f"{column}_median"], points)
        self.assertEqual(len(points), 4 + 9)
        self.assertIn("rng &lt;odd&gt; &amp;", text)
        self.assertIn("Method: <code>python3 toggles.py</code>", text)
        self.assertIn("driver_version: 1.2", text)

    def places(self, svg, axis):
        """Values and places of the ticks."""
        ticks = [tick for tick in svg.iter("text") if tick.get("data-value")]
        off = 3.6 if axis == "y" else 0  # text stands below the middle of its line
        return [(float(tick.get("data-value")), float(tick.get(axis)) - off) for tick in ticks]

    def check_interval(self, svg, axis, of):
        (a, at_a), (b, at_b) = self.places(svg, axis)[0], self.places(svg, axis)[-1]
        self.assertNotEqual(a, b)
        found = 0
        for point in svg.iter("g"):
            if not point.get("data-low"):
                continue
            bar = next(line for line in point.iter("line") if line.get("class") == "interval")
            for end, name in (("1", "data-low"), ("2", "data-high")):
                share = (of(float(point.get(name))) - of(a)) / (of(b) - of(a))
                self.assertAlmostEqual(float(bar.get(axis + end)), at_a + share * (at_b - at_a),
                                       delta=0.02)
            found += 1
        return found

    def test_intervals_are_drawn_where_the_axes_say(self):
        lines, = plots_in(self.make(image_size=sizes()))
        self.assertEqual(self.check_interval(lines, "y", math.log), 6)  # the CPU was measured once
        shutil.rmtree(self.folder)
        bars, = plots_in(self.make(toggles=toggles()))
        self.assertEqual(self.check_interval(bars, "x", float), 4)

    def test_confidence_intervals_are_preferred(self):
        row = {"kernel_ms_median": "2", "kernel_ms_min": "1", "kernel_ms_max": "4", "repeat": "10"}
        self.assertEqual(interval(row, "kernel_ms"),
                         Interval(2, 1, 4, "fastest to slowest repeat"))
        row |= {"kernel_ms_low": "1.9", "kernel_ms_high": "2.2"}
        self.assertEqual(interval(row, "kernel_ms"), Interval(2, 1.9, 2.2, "confidence interval"))
        once = {"kernel_ms_median": "2", "kernel_ms_min": "2", "kernel_ms_max": "2", "repeat": "1"}
        self.assertFalse(interval(once, "kernel_ms").known)
        rays = {"time_ms": "2", "time_min_ms": "1", "time_max_ms": "4"}
        self.assertEqual(interval(rays, "time_ms").high, 4)
        self.assertIsNone(interval({"kernel_ms_median": ""}, "kernel_ms"))

    def test_sentences_for_clear_and_unclear_differences(self):
        one, near, far = Interval(1, 0.9, 1.1), Interval(1.1, 1.05, 1.2), Interval(2, 1.9, 2.1)
        self.assertEqual(words.versus("a", one, "b", far),
                         "a (1.00 ms [0.900, 1.10]) is 2.00 times as fast as b (2.00 ms "
                         "[1.90, 2.10]).")
        self.assertRegex(words.versus("a", one, "b", near), "no significant difference between a")
        self.assertRegex(words.versus("a", one, "b", Interval(2)), "without a spread")
        self.assertEqual(words.change(far, one)[0], "faster")
        text = self.make(toggles=toggles(), image_size=sizes(), block_size=blocks((4, 3, 2, 1)))
        (_, said), = verdicts.meaning(read_table(self.folder / "toggles.csv"))
        self.assertEqual(said, "The row default takes 1.00 ms [0.980, 1.02]. Faster: rng <odd> & "
                         "\"new\" (x0.750) in time. Slower: branching reduced (x2.00) in time. "
                         "Ambiguous: scene-memory shared (x1.03).")
        split = [dict(row, x="no other change") if row["x"] == "default" else row for row in toggles()]
        write(self.folder, "toggles", split, facts("toggles", TOGGLES))
        (_, said), = verdicts.meaning(read_table(self.folder / "toggles.csv"))
        self.assertIn("The row no other change takes 1.00 ms [0.980, 1.02]. Faster: rng", said)
        self.assertEqual([one.idea for one in answers.effects(read_device(self.folder))
                          if one.table == "toggles"], [row["x"] for row in toggles()[1:]])
        self.assertIn("16 times the pixels take 16.0 times as long (time grows as pixels^1.00)",
                      text)
        self.assertIn("3 of 9 configurations were measured once and have no interval.", text)
        self.assertIn("1 of 5 configurations were not measured (refused)", text)
        self.assertIn("Take 1024 threads: over the 1 cases they take at most 1.00 times", text)

    def test_names_of_the_release_before_are_read(self):
        row = {**toggle("room", "megakernel", 1, 2, 3), "sort_hits_ms_median": "4"}
        write(self.folder, "by_itself", [row], facts("by_itself", TOGGLES))
        table = read_device(self.folder).tables["defaults"]
        self.assertEqual(interval(table.rows[0], "route_hits_ms").middle, 4)
        self.assertIn("route_hits_ms_median", table.columns)
        write(self.folder, "defaults", [], facts("defaults", TOGGLES))
        self.assertEqual(read_device(self.folder).tables["defaults"].rows, [])

    def test_metropolis_is_compared_at_equal_time(self):
        text = self.make(metropolis=metropolis(
            ("room", {0.5: (2.0, 4.0, 6.0), 0.1: (0.5, 0.6, 0.7)}), ("box", {0.1: (0.9, 1, 1.1)})))
        found = dict(verdicts.meaning(read_table(self.folder / "metropolis.csv")))
        self.assertEqual(found["room"], "relMSE of path tracing divided by that of Metropolis "
                         "light transport at equal time: 0.600 [0.500, 0.700] after 0.1 s (path tracing "
                         "wins) and 4.00 [2.00, 6.00] after 0.5 s (mlt wins).")
        self.assertIn("1.00 [0.900, 1.10] after 0.1 s (no significant difference)", found["box"])
        self.assertIn("2 of 8 configurations were measured once", found[""])
        drawn = [point for svg in plots_in(text) for point in svg.iter()
                 if (point.get("class") or "").startswith("point")]
        self.assertEqual(len(drawn), 6)
        self.assertTrue(all(point.get("data-low") for point in drawn))

    def test_ideas_are_held_against_what_they_replace(self):
        steps = [toggle("s", name, 0.99 * ms, ms, 1.01 * ms)
                 for name, ms in (("0 mega", 1.0), ("1 split", 4.0), ("2 soa", 2.0))]
        numbers = [toggle("s", name, 0.99 * ms, ms, 1.01 * ms)
                   for name, ms in (("Philox", 1.0), ("XORWOW", 1.5))]
        pools = [{**one, "panel": "s", "series": series, "x": 64, "pool": "64K"} for one, series in
                 ((toggle("s", "a", 3.9, 4.0, 4.1), "filled when empty"),
                  (toggle("s", "b", 0.9, 1.0, 1.1), "regenerated"))]
        text = self.make(ladder=[{**step, "gain": ""} for step in steps])
        self.assertIn("Time against the step before: 1 split x4.00 and 2 soa x0.500.", text)
        self.make(ladder=steps, random_numbers=numbers, scene_memory=places(), pool_size=pools)
        found = [(effect.idea, effect.where, words.show(effect.ratio), effect.word, effect.table)
                 for effect in answers.effects(read_device(self.folder))]
        self.assertEqual(found, [
            ("step 1 split", "s, after 0 mega", "4.00", "slower", "ladder"),
            ("step 2 soa", "s, after 1 split", "0.500", "faster", "ladder"),
            ("XORWOW, against Philox", "s", "1.50", "slower", "random_numbers"),
            ("regenerated, against filled when empty", "s, 64K paths", "0.250", "faster",
             "pool_size"),
            ("shared, against global", "megakernel, brute, 50 spheres", "0.500", "faster",
             "scene_memory"),
            ("shared, against global", "megakernel, brute, 1000 spheres", "1.01", "same",
             "scene_memory")])
        self.assertIn("The largest gains: regenerated, against filled when empty (s, 64K paths, x0.250), "
                      "step 2 soa", answers.each_idea(read_device(self.folder)))

    def test_an_axis_without_a_label_is_named_by_its_panel(self):
        rows = [{**toggle("triangles", "", 0.99 * ms, ms, 1.01 * ms), "series": "megakernel",
                 "x": count} for count, ms in ((10, 1), (1000, 100))]
        text = self.make(growth=rows)
        self.assertIn("100 times the triangles take 100 times as long (time grows as "
                      "triangles^1.00)", text)
        self.assertRegex(text, r'class="axis middle"[^>]*>triangles</text>')

    def scaling_rows(self):
        rows = []
        for panel, series, count, wall, efficiency, expected in (
                ("strong", "devices", 1, 100, (1, 1, 1), ""),
                ("strong", "devices", 2, 52, (0.95, 0.96, 0.97), 0.98),
                ("strong", "devices", 4, 26, (0.9, 0.96, 0.99), 0.95),
                ("strong", "ranks", 2, 54, (0.91, 0.92, 0.93), 0.9),
                ("weak", "devices", 2, 104, (0.95, 0.96, 0.97), "")):
            low, middle, high = efficiency
            rows.append({
                **toggle("wavefront", count, 0.9 * wall, wall, wall), "experiment": "scaling",
                "name": f"{panel}: {count} {series}", "panel": panel, "series": series,
                "efficiency_low": low, "efficiency_median": middle, "efficiency_high": high,
                "predicted": expected, "outside_ms": 0.1 * wall, "wall_ms_median": wall,
                "wall_ms_low": 0.9 * wall, "wall_ms_high": wall, "scene": "boxes", "spp": 9})
        return rows

    def test_several_devices_beside_their_prediction(self):
        plot = {"kind": "lines", "title": "Efficiency", "x_label": "devices or ranks",
                "y_label": "efficiency", "y": "efficiency", "log_y": False, "mark": 1}
        write(self.folder, "scaling", self.scaling_rows(), facts("scaling", plot))
        self.run_report(self.folder)
        text = (self.folder / "report.html").read_text(encoding="utf-8")
        self.check_well_formed(text)
        self.assertIn("Efficiency against one device: 0.960 [0.950, 0.970] with 2 (simulated 0.980: "
                      "worse than predicted) and 0.960 [0.900, 0.990] with 4 (simulated 0.950: as "
                      "predicted).", text)
        self.assertIn("0.920 [0.910, 0.930] with 2 (simulated 0.900: better than predicted)", text)
        self.assertIn("<b>weak, devices.</b> Efficiency against one device: 0.960 [0.950, 0.970] with "
                      "2.<", text)
        answer = re.search("What do several devices give.*?</article>", text, re.S)[0]
        self.assertIn("One image (boxes, 600x300, 9 samples)", answer)
        self.assertEqual(re.findall(r'<th scope="row">([^<]*)<', answer),
                         ["2 devices", "4 devices", "2 ranks"])
        self.assertEqual(re.findall(r'class="verdict \w+">([^<]*)<', answer),
                         ["worse than predicted", "as predicted", "better than predicted"])
        self.assertEqual(answer.count("10.0 %"), 3)

    def test_whole_processes_in_parts(self):
        columns = [("process_start_ms", "start"), ("process_prepare_ms", "trees"),
                   ("process_kernels_ms", "kernels"), ("process_undivided_ms", "not divided")]
        plot = {**TOGGLES, "kind": "stack", "y": "process_wall_ms", "parts": columns}

        def process(name, wall, kernel_ms, verdict="", **parts):
            return {**toggle("", name, kernel_ms, kernel_ms, kernel_ms), "name": name, "panel": "",
                    "process_wall_ms": wall, "process_wall_ms_low": 0.9 * wall,
                    "process_wall_ms_high": 1.1 * wall, "over_ms": 25 if verdict else "",
                    "goal_ms": 20 if verdict else "", "verdict": verdict,
                    **{f"process_{part}_ms": ms for part, ms in parts.items()}}
        rows = [process("--list-devices", 16, "", undivided=16),
                process("statue", 200, 40, "MISS", start=50, prepare=110, kernels=40),
                process("boxes", 100, 60, start=25, prepare=15, kernels=60)]
        write(self.folder, "process_time", rows, facts("process_time", plot))
        self.run_report(self.folder, "--plots", self.folder)
        text = (self.folder / "report.html").read_text(encoding="utf-8")
        self.check_well_formed(text)
        self.assertIn("Trees: the largest part of 1 of 2 processes, statue (55 %).", text)
        self.assertIn("Kernels: the largest part of 1 of 2 processes, boxes (60 %).", text)
        answer = re.search("Where does the time of a whole process go.*?</article>", text, re.S)[0]
        self.assertIn("For comparison: --list-devices 16.0 ms.", answer)
        self.assertIn(">200 [180, 220]</td>", answer)
        self.assertIn("<td>trees 55 %, start 25 %, kernels 20 %</td>", answer)
        self.assertEqual(re.findall(r'class="verdict (\w+)">([^<]*)<', answer), [("bad", "MISS")])
        bars = {}
        svg = ElementTree.parse(self.folder / "process_time.svg").getroot()
        for group in svg.iter("{http://www.w3.org/2000/svg}g"):
            if (group.get("class") or "").startswith("point"):
                bars[group.get("data-middle")] = [
                    tuple(float(rect.get(side)) for side in ("x", "width"))
                    for rect in group.iter("{http://www.w3.org/2000/svg}rect")]
        self.assertEqual(list(map(len, bars.values())), [1, 3, 3])
        (begin, start), (after_start, trees), (after_trees, kernels) = bars["200.0"]
        self.assertAlmostEqual(trees / start, 110 / 50, delta=0.01)
        self.assertAlmostEqual(kernels / start, 40 / 50, delta=0.01)
        self.assertAlmostEqual(after_start, begin + start, delta=0.02)
        self.assertAlmostEqual(after_trees, after_start + trees, delta=0.02)
        self.assertEqual([name for name in ("start", "trees", "kernels", "not divided")
                          if f">{name}</text>" in text], ["start", "trees", "kernels", "not divided"])
        shutil.rmtree(self.folder)
        self.assertIn("there is no table of process_time", self.make(toggles=toggles()))

    def test_a_series_without_numbers_is_not_judged(self):
        """As of a table that was cut off."""
        plot = {"kind": "lines", "y": "share", "mark": 0.8, "x_label": "items"}
        rows = [toggle("scan", "1", 1, 2, 3, series="scan", x="1", share="0.9"),
                toggle("cub", "1", 1, 2, 3, series="cub", x="1", share="")]
        write(self.folder, "compaction", rows, facts("compaction", plot))
        text = " ".join(of for _, of in verdicts.meaning(read_table(self.folder / "compaction.csv")))
        self.assertNotIn("cub", text)

    def test_several_devices_that_nobody_measured(self):
        simulated = [{"experiment": "scaling", "name": "8 GPUs", "status": "measured", "x": 8,
                      "panel": "a", "series": "b", "efficiency_median": 0.9}]
        for rows, description in (([], None), (simulated, {"experiment": "scaling",
                                                           "simulated": True})):
            text = self.make(toggles=toggles())
            if rows:
                write(self.folder, "scaling", rows, description)
                self.run_report(self.folder)
                text = (self.folder / "report.html").read_text(encoding="utf-8")
            self.check_well_formed(text)
            self.assertIn("there is no table of scaling", text)

    def test_quick_tables_are_shown_but_not_judged(self):
        write(self.folder, "toggles", toggles(), facts("toggles", TOGGLES, quick=True))
        self.run_report(self.folder)
        text = (self.folder / "report.html").read_text(encoding="utf-8")
        self.assertIn("say nothing about speed", text)
        self.assertIn("Quick tables are not judged, and of toggles there is no other", text)
        self.assertNotIn("no table of toggles", text)
        self.assertIn("This was not measured: there is no table block_size.", text)
        self.assertNotIn(">refuted<", text)

    def test_page_stands_alone(self):
        write(self.folder, "plain", [{"a": 1, "b": "<x>"}], None)
        page = self.check_well_formed(self.make(toggles=toggles(), image_size=sizes(),
                                                block_size=blocks((4, 3, 2, 1))))
        self.assertTrue({"answers", "claims", "toggles", "image-size"} <=
                        {name.replace("_", "-") for name in page.ids})
        self.assertIn("plain.csv", page.references)

    def test_names_are_text_wherever_they_stand(self):
        """Markup of a stranger in every field, column, name and fact: no element of the page is his."""
        evil = "<td><img src=x onerror=alert(1)>\"'</title></svg></script><script>alert(2)</script>\x1b]0;\u202e&"
        def fields(row):
            return {key: evil + str(value) if isinstance(value, str) and
                    key not in ("status", "repeat", "experiment", "commit") else value
                    for key, value in row.items()}
        plots = {"toggles": TOGGLES, "image_size": SIZES, "block_size": {**SIZES, "y": "kernel_ms"}}
        for name, rows in (("toggles", toggles()), ("image_size", sizes()), ("block_size", blocks((4, 3, 2, 1)))):
            more = facts(name, {**plots[name], "title": evil, "x_label": evil, "y_label": evil})
            more.update(question=evil + ": " + evil, command=evil, program=[evil], conclusions=[evil],
                        gpus=["name, " + evil, "G, " + evil], host={"cpu": evil, "cores": 4, "system": evil},
                        device={"choice": "cuda:0", "name": evil, "detail": evil})
            # What is a number or chooses a way of executing stays so that all tables are drawn.
            kept = ("mode", "device_kind", "panel") if name != "toggles" else ("mode",)
            write(self.folder, name, [{**fields(row), **{key: row[key] for key in kept if key in row}}
                                      for row in rows], more)
        # A scene of that name is in sentences, too.
        write(self.folder, "defaults", [
            {**toggle("", "x", 1, time, 4), "experiment": "defaults", "scene": evil, "panel": evil, "mode": mode}
            for mode, time in (("megakernel", 2.0), ("wavefront", 3.0))], facts("defaults", TOGGLES))
        script = "javascript:alert(3)"
        write(self.folder, script, [{evil: evil, "b": 1, "c": evil + "2"}], None)
        (self.folder / "a<b>.png").write_bytes(PIXEL)
        (self.folder / "a<b>.reference.png").write_bytes(PIXEL)
        svgs = self.folder.parent / "svgs"
        self.run_report(self.folder, "--plots", svgs)
        text = (self.folder / "report.html").read_text(encoding="utf-8")
        other = self.folder.parent / evil.replace("/", "")
        shutil.copytree(self.folder, other)
        both = self.folder.parent / "both.html"
        self.run_report(self.folder, other, "-o", both)
        page = Page(both.read_text(encoding="utf-8"))
        self.assertEqual((page.wrong, {name for name in page.attributes if name.startswith("on")}), ([], set()))
        self.assertNotIn("<img src=x", both.read_text(encoding="utf-8"))
        clean = self.make(toggles=toggles(), image_size=sizes(), block_size=blocks((4, 3, 2, 1)))
        page, expected = Page(text), Page(clean)
        self.assertEqual(page.wrong, [])
        self.assertEqual(len(re.findall("<script", text)), len(re.findall("<script", clean)))
        self.assertNotRegex(text, "<img src=x|[\x00-\x08\x0b-\x1f\u202e]")
        self.assertGreater(text.count("&lt;td&gt;&lt;img src=x"), 40)
        for reference in page.references:
            self.assertRegex(reference, r"^(#|data:image/png;base64,|[\w%-]+\.csv$)")
        self.assertIn("javascript%3Aalert%283%29.csv", page.references)
        self.assertFalse({name for name in page.attributes if name.startswith("on")})
        self.assertEqual(text.count("<img "), 2, "the pair of pictures")
        self.assertLessEqual(page.tags, expected.tags | {"img", "b", "label", "input", "output", "ul", "li"})
        self.assertTrue(plots_in(text))
        for path in svgs.glob("*.svg"):
            ElementTree.parse(path)

    def test_columns_of_tables_of_their_own_and_long_tables(self):
        rows = [{"experiment": "counters", "name": f"row {n}", "status": "measured", "message": "",
                 "commit": f"abc{n}", "kernel": "intersect", "issue": n / 8,
                 "kernel_ms_median": 1 + n} for n in range(250)]
        write(self.folder, "counters", rows, {**facts("counters", None), "plot": None})
        self.run_report(self.folder)
        text = (self.folder / "report.html").read_text(encoding="utf-8")
        self.check_well_formed(text)
        heads = re.findall(r'<button type="button">([^<]*)</button>',
                           text[text.index('id="counters"'):])
        self.assertEqual(heads, ["name", "issue", "kernel ms median"])
        self.assertEqual(len(re.findall('<th scope="row">row ', text)), 150)
        self.assertIn("The first 150 of 250 rows; counters.csv has all.", text)

    def test_pairs_of_pictures(self):
        self.folder.mkdir()
        for name in ("a.png", "a.reference.png", "alone.png", "big.png", "big.reference.png"):
            (self.folder / name).write_bytes(PIXEL + bytes(3000 if name == "big.png" else 0))
        write(self.folder, "toggles", toggles(), facts("toggles", TOGGLES))
        self.run_report(self.folder, "--image-limit", 2)
        text = (self.folder / "report.html").read_text(encoding="utf-8")
        page = self.check_well_formed(text)
        self.assertEqual(sum(reference.startswith("data:") for reference in page.references), 2)
        self.assertIn("Larger than 2 KiB and so not on this page: big.", text)

    def test_two_devices(self):
        self.make(toggles=toggles())
        other = self.folder.parent / "device-b"
        rows = [{**row, **{f"kernel_ms_{part}": 2 * row[f"kernel_ms_{part}"]
                           for part in ("min", "median", "max")}} for row in toggles()]
        rows[3]["width"] = 24  # another image: its time says nothing
        write(other, "toggles", rows, facts("toggles", TOGGLES, device={"name": "Device B"}))
        page = self.folder.parent / "both.html"
        self.assertIn("-o FILE must name it", self.run_report(self.folder, other, fails=True))
        self.run_report(self.folder, other, "-o", page)
        text = page.read_text(encoding="utf-8")
        self.check_well_formed(text)
        self.assertIn("Over 3 configurations that both measured, Device B takes 2.00 times the "
                      "time of Device A (geometric mean; from 2.00 to 2.00). It is slower in 3. 1 "
                      "more have equal names but other images", text)
        rows[0] |= {f"kernel_ms_{part}": 8 * rows[0][f"kernel_ms_{part}"]
                    for part in ("min", "median", "max")}
        write(other, "toggles", rows, facts("toggles", TOGGLES, device={"name": "Device B"}))
        self.run_report(self.folder, other, "-o", page)
        self.assertIn("takes 4.00 times the time of Device A (geometric mean; from 2.00 to 16.0)",
                      page.read_text(encoding="utf-8"))  # 16, 2, 2; arithmetically 6.67
        # The row of a name: A's time, B's, and B / A with the interval of the extremes.
        row = re.search(r'<th scope="row">megakernel: default</th>(.*?)</tr>', text, re.S)[1]
        self.assertEqual(re.findall('data-v="([^"]*)"', row), ["1.0", "2.0", "2.0"])
        self.assertIn("2.00 [1.92, 2.08]", row)
        first, second = plots_in(text)
        self.assertEqual(self.places(first, "x"), self.places(second, "x"))
        shutil.copy(self.folder / "toggles.json", other / "toggles.json")
        self.run_report(self.folder, other, "-o", page)
        self.assertIn("Device A (device-b)", page.read_text(encoding="utf-8"))

    def test_plots_as_files(self):
        self.make(toggles=toggles(), image_size=sizes())
        self.run_report(self.folder, "--plots", self.folder / "plots")
        for name in ("toggles", "image_size"):
            text = (self.folder / "plots" / f"{name}.svg").read_text(encoding="utf-8")
            self.assertTrue(ElementTree.fromstring(text).tag.endswith("svg"))
            self.assertNotIn("var(", text)

    def test_what_cannot_be_read_is_named(self):
        self.assertIn("nowhere: no such folder", self.run_report("nowhere", fails=True))
        self.folder.mkdir()
        self.assertIn("no tables", self.run_report(self.folder, fails=True))
        write(self.folder, "toggles", toggles(), None)
        (self.folder / "toggles.json").write_text("{", encoding="utf-8")
        error = self.run_report(self.folder, fails=True)
        self.assertIn("toggles.json: not JSON", error)
        self.assertEqual(len(error.splitlines()), 1)

    def test_words_by_hand(self):
        for value, text in ((0, "0"), (1.094, "1.09"), (29.46, "29.5"), (104678.4, "104,678"),
                            (0.00123456, "0.00123"), (-2, "-2.00")):
            self.assertEqual(words.show(value), text)
        for value, text in ((512, "512"), (4096, "4096"), (2000, "2k"), (180e3, "180k"),
                            (2.88e6, "2.88M"), (3e9, "3G"), (1.25, "1.25")):
            self.assertEqual(words.short(value), text)
        fast, slow = Interval(2, 1.9, 2.2), Interval(3, 2.2, 3.5)
        self.assertEqual(words.with_interval(fast, "ms"), "2.00 ms [1.90, 2.20]")
        self.assertEqual(words.relation(fast, slow), "overlap")  # they touch
        self.assertEqual(words.relation(slow, fast), "overlap")
        slow = Interval(3, 2.3, 3.5)
        self.assertEqual(words.change(fast, slow), ("slower", 1.5))
        self.assertEqual(words.change(slow, fast), ("faster", 2 / 3))
        self.assertEqual(words.versus("A", fast, "B", slow),
                         "A (2.00 ms [1.90, 2.20]) is 1.50 times as fast as B (3.00 ms [2.30, 3.50])"
                         ".")
        self.assertEqual(words.quotient(Interval(6, 4, 8), Interval(2, 1, 4)), Interval(3, 1, 8))
        self.assertEqual(Interval(2, 1, 4).inverse(), Interval(0.5, 0.25, 1))
        # Logarithms to 10: 0, 1, 2 and 0, 3, 1; by least squares the slope is 1/2.
        self.assertAlmostEqual(words.exponent([(1, 1), (10, 1000), (100, 10)]), 0.5)

    def test_efficiency_is_held_against_its_interval(self):
        row = {"efficiency_median": "0.8", "efficiency_min": "0.7", "efficiency_max": "0.9"}
        for predicted, text in (("0.85", "as predicted"), ("0.75", "as predicted"),
                                ("0.95", "worse than predicted"), ("0.9", "as predicted"),
                                ("0.65", "better than predicted"), ("", "not predicted")):
            self.assertEqual(against_prediction({**row, "predicted": predicted}), text)
        self.assertEqual(against_prediction({"efficiency": "0.8", "predicted": "1"}), "not known")

    def test_axes_have_air(self):
        self.assertEqual(domain([Interval(10, 5, 20)], True), (5 / 1.3, 26))
        self.assertEqual(domain([Interval(10, 5, 50)], False), (0, 53))
        self.assertEqual(Scale(1, 1000, True, 0, 1).ticks(), [1, 10, 100, 1000])
        self.assertEqual(Scale(1, 100, True, 0, 1).ticks(), [1, 2, 5, 10, 20, 50, 100])

    def test_the_block_that_loses_least(self):
        times = {"A": {"64": 2, "128": 3}, "B": {"64": 6, "128": 2}}
        rows = [{"panel": panel, "series": "s", "x": x, "commit": "abcdefghi",
                 "kernel_ms_median": str(ms), "kernel_ms_min": str(ms - 0.25),
                 "kernel_ms_max": str(ms + 0.5)}
                for panel, sizes in times.items() for x, ms in sizes.items()]
        page = answers.which_block(Device(None, "D", {"block_size": Table("block_size", [], rows)}))
        for part in ("Take 128 threads: over the 2 cases they take at most 1.50 times as long as the "
                     "best size of the case. 64 threads take up to 3.00 times as long.",
                     "128 (x1.50)", "64 (x3.00)", "commit abcdefg)"):
            self.assertIn(part, page)

    def test_scales(self):
        scale = Scale(1, 100, True, 0, 10)
        self.assertAlmostEqual(scale(10), 5)
        self.assertEqual(scale.ticks(), [1, 2, 5, 10, 20, 50, 100])
        self.assertEqual(Scale(0, 10.5, False, 0, 1).ticks(), [0, 2, 4, 6, 8, 10])
        self.assertEqual([words.show(x) for x in (0.01234, 1.09096, 104678, 0)],
                         ["0.0123", "1.09", "104,678", "0"])

    def test_a_place_at_zero_has_no_logarithm(self):
        steps = [after - before for places in ([0, 128, 256], [1, 16, 256])
                 for scale in [scale_over(places)]
                 for before, after in zip(map(scale, places), map(scale, places[1:]))]
        self.assertAlmostEqual(steps[0], steps[1])
        self.assertAlmostEqual(steps[2], steps[3])
        self.assertGreater(min(steps), 0)

    def test_committed_page_is_that_of_the_committed_tables(self):
        page = self.folder.parent / "page.html"
        self.run_report(RESULTS, "-o", page)
        self.check_well_formed(page.read_text(encoding="utf-8"))
        self.assertLess(page.stat().st_size, 4_500_000)
        self.assertEqual(page.read_bytes(), (RESULTS / "report.html").read_bytes(),
                         "run scripts/report and commit the page")


class Browser(unittest.TestCase):
    SCRIPT = """<script>
addEventListener("error", (event) => document.body.append("ERROR " + event.message));
addEventListener("load", () => {
  const column = [...document.querySelectorAll("#toggles th")].find((head) =>
    head.textContent === "kernel ms median");
  column.querySelector("button").click();
  const first = column.closest("table").tBodies[0].rows[0].cells[column.cellIndex].dataset.v;
  const slider = document.querySelector(".slider");
  slider.value = 20;
  slider.dispatchEvent(new Event("input"));
  const at = document.querySelector(".frame").style.getPropertyValue("--at");
  const shown = [...document.querySelectorAll("svg.plot")].every((plot) =>
    plot.getBoundingClientRect().height > 100);
  document.body.append(`FIRST ${first} AT ${at} SHOWN ${shown}`);
});
</script></head>"""

    @unittest.skipUnless(shutil.which("node"), "no node to read the script")
    def test_script_is_javascript(self):
        subprocess.run(["node", "--check", ROOT / "scripts" / "report_parts" / "page.js"],
                       check=True)

    def test_page_works(self):
        browser = shutil.which("chromium") or shutil.which("google-chrome")
        if not browser:
            self.skipTest("no chromium or google-chrome on PATH")
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            write(folder, "toggles", toggles(), facts("toggles", TOGGLES))
            for picture in ("a.png", "a.reference.png"):
                (folder / picture).write_bytes(PIXEL)
            subprocess.run([sys.executable, REPORT, folder], check=True, capture_output=True)
            page = folder / "report.html"
            page.write_text(page.read_text(encoding="utf-8").replace("</head>", self.SCRIPT, 1),
                            encoding="utf-8")
            shown = subprocess.run([browser, "--headless", "--no-sandbox", "--disable-gpu",
                                    f"--user-data-dir={folder}/profile", "--dump-dom",
                                    page.as_uri()], check=True, capture_output=True, text=True,
                                   timeout=120).stdout
        self.assertIn("FIRST 0.75 AT 20% SHOWN true", shown)
        self.assertNotIn("ERROR ", shown.rpartition("</script>")[2])


if __name__ == "__main__":
    unittest.main()
