"""Keywords: type checkers know them, IPython completes them; what progress= shows."""
import inspect
import io
import json
import os
import re
import subprocess
import sys
import unittest
from pathlib import Path
from unittest import mock

from ptexp_package import TestCase, ptexp

from ptexp import _progress, _stub

try:
    import tqdm  # noqa: F401
    from IPython.core.completer import provisionalcompleter
    from IPython.core.interactiveshell import InteractiveShell
except ImportError as error:
    if os.environ.get("PTEXP_NEEDS_PYTHON"):
        raise
    raise unittest.SkipTest(f"needs the packages of tests/python/requirements.txt: {error}")

PACKAGE = Path(ptexp.__file__).parent
HEAD = "import ptexp\nscene = ptexp.load('cornell')\n"
RIGHT = """
from pathlib import Path
import ptexp

scene = ptexp.load(Path("a.xml"), width=32, define={"a": 1, "b": "x"}, strict=True, time=0.5, animation=1)
image: ptexp.Image = ptexp.render(scene, spp=4, mode="wavefront", crop=(0, 0, 4, 4), nee=False, pool_size="64K",
                                  look_from=(0, 1, 2.5), aov="depth", aperture=0, exposure="auto", rr=None, progress=True)
scene.render(filter=("gaussian", 0.5), stage_block={"shadow": 64}, output=Path("a.png"), device="cuda", quiet=False,
             regenerate="off", order_surfaces=True, fov=40.5, aov=["depth", "albedo"], part=(1, 4), seed=7,
             progress=lambda done, total: None)
plan = ptexp.explain("cornell", mode="auto", strict=True)
depths = [1, 2]
row = ptexp.sweep(scene, max_depth=depths, spp=range(1, 4), kernel=["loop", "vote"], modes="megakernel",
                  look_from=[(0, 1, 2), (0, 1, 3)], nee=False)[0]
word: str = ptexp.compare_modes(scene, spp=2, repeat=20).word
ptexp.measure("cornell", modes=["megakernel", "serial"], by_stage=True, stages="split", time_limit=1).dataframe()
ptexp.Scene.from_dict({}, spp=3, default_lighting="off", strict=True)
"""
WRONG = ["ptexp.render(scene, ssp=8)", "ptexp.load('cornell', ssp=8)", "ptexp.load_string('', ssp=8)",
         "ptexp.explain(scene, ssp=8)", "ptexp.measure(scene, ssp=8)", "ptexp.sweep(scene, ssp=[8])",
         "ptexp.compare_modes(scene, ssp=8)", "scene.render(ssp=8)", "ptexp.Scene.from_dict({}, ssp=8)",
         "ptexp.render(scene, spp='many')", "ptexp.render(scene, spp=2.5)", "ptexp.render(scene, mode='fast')",
         "ptexp.render(scene, nee='maybe')", "ptexp.render(scene, look_from=1)", "ptexp.render(scene, strict='yes')",
         "ptexp.sweep(scene, spp=['a'])", "ptexp.measure(scene, output='a.png')", "ptexp.measure(scene, modes=['fast'])",
         "scene.render(strict=True)", "ptexp.load('cornell', scene='spheres')", "ptexp.compare_modes(scene).wrod",
         "ptexp.render(scene).arrya", "ptexp.load('cornell', widht=32)"]


class Types(TestCase):
    """Of a user's script."""

    folder_of_package = os.environ.get("PTEXP_PYTHON_PATH", "")  # empty: installed

    def run_checker(self, *command):
        """A type checker on right.py and wrong.py."""
        self.write("right.py", RIGHT)
        self.write("wrong.py", HEAD + "\n".join(WRONG) + "\n")
        return subprocess.run([sys.executable, "-m", *command, "right.py", "wrong.py"], cwd=self.folder, timeout=300,
                              env={**os.environ, "MYPYPATH": self.folder_of_package}, capture_output=True, text=True, check=False)

    def check(self, errors):
        """(file, line, message) of each error: none in right.py, and one in each line of wrong.py."""
        self.assertEqual([error for error in errors if error[0] == "right.py"], [])
        lines = {line for _, line, _ in errors}
        missed = [text for number, text in enumerate(WRONG, HEAD.count("\n") + 1) if number not in lines]
        self.assertEqual(missed, [], errors)

    def test_mypy(self):
        run = self.run_checker("mypy", "--strict", "--follow-imports=silent", "--cache-dir", "cache", "--no-error-summary")
        found = [re.match(r"(\w+\.py):(\d+): error: (.*)", line) for line in run.stdout.splitlines()]
        self.check([(match[1], int(match[2]), match[3]) for match in found if match])
        self.assertRegex(run.stdout, r'widht.*did you mean "width"')

    def test_pyright(self):
        # Of the engine's wheel; the package pyright would load the engine from elsewhere when it first runs.
        self.write("pyrightconfig.json", json.dumps({"typeCheckingMode": "standard", "extraPaths": [self.folder_of_package]}))
        run = self.run_checker("basedpyright", "--pythonpath", sys.executable, "--outputjson")
        self.check([(Path(report["file"]).name, report["range"]["start"]["line"] + 1, report["message"])
                    for report in json.loads(run.stdout)["generalDiagnostics"] if report["severity"] == "error"])

    def test_the_file_of_types_is_that_of_the_table(self):
        text = (PACKAGE / "_keywords.pyi").read_text(encoding="utf-8")
        self.assertEqual(text, _stub.stub())
        compile(text, "_keywords.pyi", "exec")
        for option in ptexp.options():
            expected = 0 if option["keyword"] in ("scene", "explain") else 1
            self.assertGreaterEqual(text.count(f"    {option['keyword']}: "), expected)


class Completion(TestCase):
    def test_ipython_completes_keywords(self):
        shell = InteractiveShell.instance()
        self.addCleanup(InteractiveShell.clear_instance)
        shell.user_ns.update(ptexp=ptexp, scene=ptexp.load("cornell"))
        for use_jedi in (False, True):
            shell.Completer.use_jedi = use_jedi
            for line, expected in (("ptexp.render(scene, max_d", "max_depth="), ("ptexp.load('cornell', wid", "width="),
                                   ("ptexp.explain(scene, kern", "kernel_set="), ("ptexp.measure(scene, max_d", "max_depth="),
                                   ("scene.render(light", "light_selection="), ("ptexp.sweep(scene, war", "warmup="),
                                   ("ptexp.Scene.from_dict({}, max_d", "max_depth=")):
                with self.subTest(line, jedi=use_jedi), provisionalcompleter():
                    texts = [found.text for found in shell.Completer.completions(line, len(line))]
                    self.assertIn(expected, texts)

    def test_signatures_have_the_options_that_apply(self):
        names = set(inspect.signature(ptexp.render).parameters)
        self.assertEqual(names, {option["keyword"] for option in ptexp.options()} - {"explain"} | {"progress", "on_device"})
        self.assertNotIn("strict", inspect.signature(ptexp.load("cornell").render).parameters)
        self.assertNotIn("output", inspect.signature(ptexp.compare_modes).parameters)


class Progress(TestCase):
    def shown(self, *, is_terminal=True, **options):
        """What a render writes to a terminal, and its image."""
        stream = io.StringIO()
        stream.isatty = lambda: is_terminal
        with mock.patch.object(sys, "stderr", stream):
            ptexp.render("cornell", width=64, height=64, spp=8, progress=True, **options)
        return stream.getvalue()

    def test_a_bar_of_tqdm(self):
        text = self.shown()
        self.assertIn("100%|", text)
        self.assertRegex(text, r"32\.8k/32\.8k .*samples/s")
        self.assertTrue(text.endswith("\n"))

    def test_a_line_without_tqdm(self):
        with mock.patch.object(_progress, "find_spec", lambda name: None):
            text = self.shown()
        self.assertRegex(text, r"^\r")
        self.assertRegex(text, r"\r100 % after \d+ s *\n$")

    def test_a_repeat_has_its_own_line(self):
        stream = io.StringIO()
        stream.isatty = lambda: True
        with mock.patch.object(sys, "stderr", stream), mock.patch.object(_progress, "find_spec", lambda name: None):
            with _progress.shown(True, "samples") as tell:
                for done in (1, 4, 2, 4):
                    tell(done, 4)
        self.assertEqual([re.findall(r"(\d+) %", line) for line in stream.getvalue().split("\n")[:-1]], [["25", "100"], ["50", "100"]])

    def test_nothing_where_nobody_looks(self):
        self.assertEqual(self.shown(is_terminal=False), "")

    def test_the_bar_ends_with_what_is_raised(self):
        with mock.patch.object(_progress._Bar, "__call__", side_effect=ZeroDivisionError), self.assertRaises(ZeroDivisionError):
            self.shown()
        stream = io.StringIO()
        stream.isatty = lambda: True
        with mock.patch.object(sys, "stderr", stream), mock.patch.object(_progress, "find_spec", lambda name: None):
            with self.assertRaises(KeyError), _progress.shown(True, "samples") as tell:
                tell(1, 4)
                raise KeyError
        self.assertTrue(stream.getvalue().endswith("left\n"), stream.getvalue())


if __name__ == "__main__":
    unittest.main()
