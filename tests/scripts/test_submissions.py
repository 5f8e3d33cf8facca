"""Submissions: `scripts/reproduce --submit` with a program that makes known times, tables that nobody
should send, planted good and bad files, and what scripts/submissions and the report say of them."""
import csv
import getpass
import html
import json
import os
import re
import socket
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import test_report as planted

ROOT = Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "experiments"))
from lib import submission_files, submissions  # noqa: E402
from lib.submission_files import SubmissionError  # noqa: E402

# A ptexp whose times follow from scene and mode: the megakernel takes RATIO[scene] times as long.
RATIO = {"boxes": 1.5, "cornell": 0.8}
PROGRAM = """#!{python}
import json, sys
RATIO, COMMIT = {ratio}, "{commit}"

def answer(words):
    said = dict(zip(words, words[1:]))
    scene, mode = said["--scene"], said["--mode"]
    ms = 4.0 * (RATIO.get(scene, 1.1) if mode == "megakernel" else 1)
    row = {{"version": "0.2.0", "commit": COMMIT, "build_type": "Release", "cuda": "13.0.88",
           "fast_math": "off", "scene": scene, "width": said["--width"], "height": said["--height"],
           "spp": said["--spp"], "max_depth": said["--max-depth"], "mode": mode, "repeat": "0",
           "device_kind": "cuda", "device_name": "Fake GPU", "driver": "CUDA driver 13.0",
           "kernel_ms_median": "0", "paths": "1000", "mpaths_per_s": "0"}}
    times = [ms * (1 + number / 100) for number in range(int(said["--repeat"]))]
    return {{"row": row, "statistics": {{"runs": [{{"kernel_ms": time, "stages": []}}
                                               for time in times]}}}}

if sys.argv[1] == "--version":
    print("ptexp 0.2.0\\ncommit " + COMMIT + "\\nbuild Release, GNU 12\\nCUDA 13.0.88")
elif sys.argv[1] == "--list-devices":
    print("cpu        CPU (2 threads)\\ncuda:0     Fake GPU (2 units)")
elif sys.argv[1] == "compare":
    print("differing pixels       0")
elif sys.argv[1] == "measure":
    for line in sys.stdin:
        print(json.dumps(answer(json.loads(line)["arguments"])), flush=True)
else:
    open(sys.argv[sys.argv.index("--output") + 1], "w").close()
"""
NVIDIA_SMI = '#!/bin/sh\necho "name, driver_version"\necho "Fake GPU, 580.1.2"\n'
COMMIT = "0123456789ab"
MISSING = object()
TIMES = {"kernel_ms_median": 2.0, "kernel_ms_low": 1.9, "kernel_ms_high": 2.1, "repeat": 6, "rounds": 2}
VALUE = {"middle": 1.2, "low": 1.1, "high": 1.3}
GOOD = {
    "schema_version": 1, "tier": "minute", "date": "2026-11-29",
    "program": {"version": "0.2.0", "commit": COMMIT, "build_type": "Release",
                "cuda": "13.0.88, architectures 90", "fast_math": "off"},
    "device": {"name": "AMD Ryzen 7 7840U w/ Radeon 780M @ 3.30GHz", "kind": "cuda", "detail": "132 units",
               "driver": "580.159.04", "cuda": "CUDA driver 13.0, runtime 13.0"},
    "works": [{"scene_hash": scene, "width": 600, "height": 300, "spp": 50, "max_depth": 50,
               "table": "defaults", "megakernel": TIMES,
               "wavefront": {**TIMES, "kernel_ms_median": 1.0, "kernel_ms_low": 1.0,
                             "kernel_ms_high": 1.25}}
              for scene in ("built-in dial:16:0:closed", "sha256 0123456789abcdef")],
    "claims": [{"claim": "padilla_2026_sixteen_percent", "verdict": "holds only when",
                "table": "defaults", "cases": 9, "within": 2, "least": VALUE, "greatest": VALUE}]}
WORK = {"scene": "cornell", "width": "1024", "height": "1024", "spp": "64", "max_depth": "8",
        "repeat": "6", "rounds": "2", "scene_hash": "built-in cornell", "status": "measured",
        "device_kind": "cuda", "device_name": "Fake GPU", "version": "0.2.0", "commit": COMMIT,
        "build_type": "Release", "fast_math": "off"}


def with_value(place, value):
    """GOOD, where the key at the end of `place` has another value, or is not there."""
    facts = json.loads(json.dumps(GOOD))
    *way, last = place
    found = facts
    for key in way:
        found = found[key]
    if value is MISSING:
        del found[last]
    else:
        found[last] = value
    return facts


def run(script, *arguments, **environment):
    return subprocess.run([sys.executable, ROOT / "scripts" / script, *map(str, arguments)],
                          capture_output=True, text=True, check=False, timeout=300,
                          env={**os.environ, **environment})


def rows_of(section):
    return [[html.unescape(re.sub("<.*?>", "", cell)) for cell in re.findall(
        r"<t[dh][^>]*>(.*?)</t[dh]>", row)] for row in re.findall(r"<tr>(.*?)</tr>", section)]


class InFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="ptexp submissions ")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def plant(self, name, facts):
        path = self.folder / name
        path.write_text(facts if isinstance(facts, str) else json.dumps(facts), encoding="utf-8")
        return path


class Reproduced(InFolder):
    """A whole tier with a program that makes known times."""

    def program(self, name, text):
        path = self.folder / "programs" / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
        path.chmod(0o755)
        return path

    def reproduce(self, commit, *arguments):
        self.program("nvidia-smi", NVIDIA_SMI)
        ptexp = self.program("ptexp", PROGRAM.format(python=sys.executable, ratio=RATIO, commit=commit))
        return run("reproduce", "--tier", "minute", "--ptexp", ptexp, "--output", self.folder / "out",
                   *arguments, PATH=f"{ptexp.parent}:{os.environ['PATH']}")

    def test_a_minute_is_sent_and_read(self):
        scene = self.folder / "my-client" / "secret-villa.xml"
        scene.parent.mkdir()
        scene.write_text("<scene/>", encoding="utf-8")
        done = self.reproduce(COMMIT, "--submit", "--scenes", scene)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        table = self.folder / "out" / "minute" / "fake-gpu" / "defaults.csv"
        with open(table, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        path = self.folder / "out" / "submissions" / f"fake-gpu-minute-{COMMIT[:7]}.json"
        self.assertEqual([one.name for one in path.parent.iterdir()], [path.name])
        text = path.read_text(encoding="utf-8")
        facts = submission_files.read_submission(path).facts
        self.assertEqual({key: facts["device"][key] for key in ("name", "kind", "detail", "driver")},
                         {"name": "Fake GPU", "kind": "cuda", "detail": "2 units", "driver": "580.1.2"})
        self.assertEqual(facts["program"]["commit"], COMMIT)
        # Every row's times, as the table has them.
        self.assertEqual(len(rows), 2 * len(facts["works"]))
        for row in rows:
            mine, = [work[row["mode"]] for work in facts["works"] if work["scene_hash"] ==
                     row["scene_hash"] and str(work["width"]) == row["width"]]
            self.assertEqual({name: str(mine[name]) for name in ("repeat", "rounds")},
                             {"repeat": "6", "rounds": "2"})
            for name in submission_files.TIMES:
                self.assertEqual(mine[name], float(row[name]))
        # Two of ten scenes are not 1.1: 4 ms times 1, 1.01, 1.02 in each of two rounds.
        ratios = submission_files.read_submission(path).ratios()
        found = {work.scene: round(ratio.middle, 6) for work, (ratio, _) in ratios.items()}
        self.assertEqual({scene: found[scene] for scene in RATIO}, RATIO)
        self.assertEqual(sorted(set(found.values())), [0.8, 1.1, 1.5])
        claim, = facts["claims"]
        self.assertEqual((claim["claim"], claim["verdict"], claim["cases"], claim["within"]),
                         ("padilla_2026_sixteen_percent", "holds only when", 10, 1))
        # Nothing of the machine, of its user and of the scene's name; of the date the day.
        for secret in (socket.gethostname(), getpass.getuser(), self.folder.name, "my-client",
                       "secret-villa", str(ROOT), sys.version.split()[0]):
            self.assertNotIn(f'"{secret}', text)
            self.assertNotRegex(text, rf"[ /]{re.escape(secret)}\b")
        self.assertNotRegex(text, r"\d\d:\d\d|/\w")

    def test_what_nobody_should_send_is_refused_before_it_is_measured(self):
        for commit in (f"{COMMIT}-dirty", "unknown"):
            done = self.reproduce(commit, "--submit")
            self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), done.stderr)
            self.assertIn(f"is of commit {commit}; expected a clean one", done.stderr)
            self.assertFalse((self.folder / "out").exists())
        for option in ("--quick", "--only=defaults"):
            done = self.reproduce(COMMIT, "--submit", option)
            self.assertEqual(done.returncode, 2)
            self.assertIn("expected neither --only nor --quick", done.stderr)


class Tables(InFolder):
    """Hand-made tables."""

    def write(self, name, change_facts=(), change_row=()):
        rows = [{**WORK, "name": f"cornell: {mode}", "mode": mode, "kernel_ms_median": ms,
                 "kernel_ms_low": 0.99 * ms, "kernel_ms_high": 1.01 * ms, **dict(change_row)}
                for mode, ms in (("megakernel", 4.0), ("wavefront", 2.0))]
        planted.write(self.folder, name, rows, planted.facts(name, planted.TOGGLES, **{
            "complete": True, "program": ["ptexp 0.2.0", f"commit {COMMIT}"], **dict(change_facts)}))

    def error_of(self, names=("defaults",)):
        with self.assertRaises(SubmissionError) as caught:
            submissions.submission_of(self.folder, names, "minute")
        return str(caught.exception)

    def test_good_ones(self):
        self.write("defaults")
        work, = submissions.submission_of(self.folder, ["defaults"], "minute")["works"]
        self.assertEqual(work["scene_hash"], "built-in cornell")
        self.assertEqual([work[mode]["kernel_ms_low"] for mode in ("megakernel", "wavefront")],
                         [3.96, 1.98])

    def test_refused_ones_say_which(self):
        for change_facts, change_row, said in (
                ({"complete": False}, {}, "table defaults is incomplete; the same command goes on"),
                ({}, {"status": "failed"}, "table defaults is incomplete (cornell: megakernel: failed)"),
                ({}, {"status": "pending"}, "is incomplete (cornell: megakernel: pending)"),
                ({"quick": True}, {}, "table defaults was made with --quick"),
                ({"program": ["ptexp 0.2.0", f"commit {COMMIT}-dirty"]}, {},
                 f"table defaults is of commit {COMMIT}-dirty; expected a clean one"),
                ({"program": ["ptexp 0.2.0"]}, {}, "table defaults is of commit unknown"),
                ({}, {"commit": "fedcba987654"},
                 f"tables of several commits: defaults has {COMMIT}, defaults has fedcba987654"),
                ({"gpus": ["name, driver_version", "A, 1.2", "A, 1.3"]}, {},
                 "tables of several drivers: defaults has 1.2, defaults has 1.3"),
                ({}, {"scene_hash": "built-in my/scene"}, "works[0].scene_hash: expected 'built-in SCENE'"),
                ({}, {"build_type": "Release of me@home"}, "program.build_type: 'Release of me@home' may "
                                                           "name a path or a host"),
                ({}, {"mode": "megakernel"}, "works: expected one or more")):
            self.write("defaults", change_facts, change_row)
            self.assertIn(said, self.error_of(), said)
        self.write("defaults")
        self.assertIn("table sizes is missing", self.error_of(["defaults", "sizes"]))
        self.write("sizes", {"program": ["ptexp 0.2.0", "commit fedcba987654"]},
                   {"commit": "fedcba987654"})
        self.assertIn(f"defaults has {COMMIT}, sizes has fedcba987654; expected one",
                      self.error_of(["defaults", "sizes"]))
        (self.folder / "defaults.json").unlink()
        self.assertIn("defaults.json is missing", self.error_of())


class Files(InFolder):
    def test_a_good_one(self):
        submission = submission_files.read_submission(self.plant("good.json", GOOD))
        self.assertEqual([(str(work), ratio.middle, ratio.low, ratio.high, word)
                          for work, (ratio, word) in submission.ratios().items()][0],
                         ("dial:16:0:closed 600x300, 50 samples, depth 50", 2.0, 1.9 / 1.25, 2.1, "faster"))

    def test_what_is_wrong_is_named_with_file_and_key(self):
        mode = ("works", 0, "megakernel")
        for place, value, said in (
                (["schema_version"], 2, "schema_version: 2; expected 1"),
                (["schema_version"], "1", "schema_version: expected a whole number from 1 to 1"),
                (["schema_version"], MISSING, "schema_version: missing"),
                (["host"], "mine", "host: unknown key; expected one of schema_version"),
                (["tier"], "hour", "tier: expected one of minute, ten, all"),
                (["date"], "2026-11-29T12:00:00", "date: expected a day"),
                (["program"], [], "program: expected an object"),
                (["program", "commit"], f"{COMMIT}-dirty", "program.commit: expected a commit"),
                (["program", "fast_math"], True, "program.fast_math: expected one of on, off"),
                (["device", "user"], "me", "device.user: unknown key"),
                (["device", "name"], "", "device.name: expected a text"),
                (["device", "name"], "A" * 121, "device.name: expected a text"),
                (["device", "name"], "A\nB", "device.name: expected a text"),
                *((["device", where], value, f"device.{where}: {value!r} may name a path or a host")
                  for where, value in (
                      ("name", "/home/me"), ("name", "in ~me"), ("name", "a C:\\B"), ("detail", "a/b"),
                      ("detail", "gpu17.cluster.local"), ("cuda", "me@home"), ("cuda", "at 192.168.0.1"),
                      ("name", "fe80::1"), ("name", "my-scene.xml"), ("name", "00:1b:44:11:3a:b7"))),
                (["works"], {}, "works: expected a list"),
                (["works"], [], "works: expected one or more"),
                (["works", 1], 3, "works[1]: expected an object"),
                (["works", 1, "scene_hash"], "my-scene", "works[1].scene_hash: expected 'built-in SCENE'"),
                (["works", 1, "scene_hash"], GOOD["works"][0]["scene_hash"],
                 "works[1]: dial:16:0:closed 600x300, 50 samples, depth 50 is there twice"),
                (["works", 0, "width"], 0, "works[0].width: expected a whole number from 1 to"),
                (["works", 0, "spp"], 1.5, "works[0].spp: expected a whole number"),
                (["works", 0, "max_depth"], True, "works[0].max_depth: expected a whole number"),
                (["works", 0, "wavefront"], MISSING, "works[0].wavefront: missing"),
                ([*mode, "kernel_ms_low"], 2.05, "works[0].megakernel.kernel_ms_median: 2.0 is outside"),
                ([*mode, "kernel_ms_high"], 1.95, "works[0].megakernel.kernel_ms_median: 2.0 is outside"),
                ([*mode, "kernel_ms_low"], -1, "works[0].megakernel.kernel_ms_low: expected a time in ms"),
                ([*mode, "kernel_ms_low"], "1.9", "works[0].megakernel.kernel_ms_low: expected a time"),
                ([*mode, "kernel_ms_high"], 1e300, "works[0].megakernel.kernel_ms_high: expected a time"),
                ([*mode, "rounds"], 7, "works[0].megakernel.rounds: expected at most as many"),
                (["claims", 0, "claim"], "nobody", "claims[0].claim: 'nobody' is no file"),
                (["claims", 0, "verdict"], "true", "claims[0].verdict: expected one of reproduced"),
                (["claims", 0, "verdict"], "refuted", "claims[0].verdict: 'refuted' does not go with 2 of 9"),
                (["claims", 0, "within"], 9, "claims[0].verdict: 'holds only when' does not go with 9 of 9"),
                (["claims", 0, "least", "low"], 1.25, "claims[0].least.middle: 1.2 is outside"),
                (["claims", 0, "greatest", "high"], MISSING, "claims[0].greatest.high: missing"),
                (["claims", 0, "greatest", "high"], None, "claims[0].greatest.middle: 1.2 is outside"),
                (["claims", 0, "greatest", "middle"], 1.15,
                 "claims[0].least.middle: expected at most greatest.middle"),
                (["claims"], GOOD["claims"] * 2, "claims[1].claim: 'padilla_2026_sixteen_percent' is there")):
            path = self.plant("bad.json", with_value(place, value))
            with self.assertRaises(SubmissionError, msg=said) as caught:
                submission_files.read_submission(path)
            self.assertTrue(str(caught.exception).startswith(f"{path}: {said}"), caught.exception)

    def test_what_is_no_json(self):
        text = json.dumps(GOOD)
        for content, said in (("{", "not JSON in UTF-8"), ("[]", "the file: expected an object"),
                              ("[" * 100000, "not JSON in UTF-8"),
                              (text.replace("1.9", "NaN"), "NaN is no number"),
                              (text.replace('"high": 1.3', '"high": 1e999'), "expected a number, or null"),
                              ('{"tier": "ten", ' + text[1:], "a key is there twice"),
                              (text + " " * (1 << 20), "larger than 1 MiB")):
            path = self.plant("bad.json", content)
            with self.assertRaisesRegex(SubmissionError, re.escape(said)):
                submission_files.read_submission(path)

    def test_the_list_and_the_map(self):
        other = with_value(["device", "name"], "Other GPU")
        other["works"][1]["width"] = 64
        other["works"][1]["megakernel"] = {**TIMES, "kernel_ms_median": 0.5, "kernel_ms_low": 0.5,
                                           "kernel_ms_high": 0.625}
        good = [self.plant("a.json", GOOD), self.plant("b.json", other)]
        done = run("submissions", *good, "--map")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        lines = done.stdout.splitlines()
        self.assertRegex(lines[0], r"^a: AMD Ryzen.*driver 580\.159\.04.*ptexp 0\.2\.0 0123456 Release, "
                                   r"2026-11-29, tier minute, wavefront faster in 2 of 2 works, claims: 1$")
        self.assertRegex(lines[1], "^b: Other GPU.* wavefront faster in 1 and slower in 1 of 2 works, ")
        self.assertRegex(lines[3], r"^megakernel / wavefront  .*GHz  +Other GPU$")
        value = re.escape("2.00 [1.52, 2.10]")
        self.assertRegex(lines[4], rf"^dial:16:0:closed 600x300, .*  {value}  +{value}$")
        self.assertRegex(lines[5], rf"^sha256 0123456789abcdef 600x300, .*  {value}  +-$")
        self.assertRegex(lines[6], r"^sha256 0123456789abcdef 64x300, .*  -  +0\.500 \[0\.400, 0\.625\]$")
        self.assertEqual(len(lines), 7)
        bad = self.plant("c.json", with_value(["tier"], "hour"))
        done = run("submissions", good[0], bad, self.folder / "nothing.json")
        self.assertEqual((done.returncode, len(done.stdout.splitlines())), (1, 1))
        self.assertIn(f"{bad}: tier: expected one of", done.stderr)
        self.assertIn("nothing.json: No such file", done.stderr)

    def test_those_of_the_repository(self):
        done = run("submissions")
        self.assertEqual((done.returncode, done.stderr), (0, ""))


class Page(InFolder):
    def page(self, *arguments):
        path = self.folder / "page.html"
        done = run("report", self.folder / "device-a", "-o", path, *arguments)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return path.read_text(encoding="utf-8")

    def setUp(self):
        super().setUp()
        rows = [{**planted.toggle("", mode, 0.99 * ms, ms, 1.01 * ms), **WORK, "scene": "/x/hall/scene.xml",
                 "scene_hash": "sha256 0123456789abcdef", "mode": mode, "width": 600, "height": 300,
                 "spp": 50, "max_depth": 50} for mode, ms in (("megakernel", 3.0), ("wavefront", 2.0))]
        planted.write(self.folder / "device-a", "defaults", rows,
                      planted.facts("defaults", planted.TOGGLES, complete=True))

    def test_without_submissions_it_keeps_its_bytes(self):
        (self.folder / "none").mkdir()
        texts = [self.page("--submissions", self.folder / name) for name in ("none", "nowhere")]
        self.assertEqual(texts[0], texts[1])
        self.assertNotIn('id="devices"', texts[0])
        self.assertNotIn("Other devices", texts[0])
        self.assertIn('</section>\n<section id="others">', texts[0])

    def test_a_column_for_each_device(self):
        folder = self.folder / "sent"
        folder.mkdir()
        for name, facts in (("a", with_value(["device", "name"], "GPU <B>")),
                            ("b", with_value(["works", 1, "scene_hash"], "built-in cornell"))):
            self.plant(f"sent/{name}.json", facts)
        section = self.page("--submissions", folder)
        section = section.partition('<section id="devices">')[2].partition("</section>")[0]
        self.assertNotIn("<B>", section)
        heads, *works = rows_of(section.partition("</table>")[0])
        device = GOOD["device"]["name"]
        self.assertEqual(heads, ["scene", "image", "samples", "depth", "Device A, this page", "GPU <B>",
                                 device])
        image, theirs = ["600x300", "50", "50"], "2.00 [1.52, 2.10]"
        self.assertEqual(works, [["cornell", *image, "", "", theirs],
                                 ["dial:16:0:closed", *image, "", theirs, theirs],
                                 ["hall/scene.xml", *image, "1.50 [1.47, 1.53]", theirs, ""]])
        heads, *claims = rows_of(section.partition("</table>")[2])
        self.assertEqual(heads, ["claim", "Device A, this page", "GPU <B>", device])
        self.assertEqual([row[0] for row in claims], ["padilla_2026_sixteen_percent"])
        self.assertEqual(claims[0][2:], ["holds only when (2 of 9 cases)"] * 2)

    def test_a_bad_one_is_an_error(self):
        (self.folder / "sent").mkdir()
        path = self.plant("sent/bad.json", with_value(["tier"], "hour"))
        done = run("report", self.folder / "device-a", "-o", self.folder / "page.html", "--submissions",
                   path.parent)
        self.assertEqual(done.returncode, 1)
        self.assertIn(f"scripts/report: error: {path}: tier: expected", done.stderr)


if __name__ == "__main__":
    unittest.main()
