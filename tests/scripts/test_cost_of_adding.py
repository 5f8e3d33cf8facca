"""The additions that scripts/cost_of_adding counts still apply, cost no more than they may, and are
in the table of docs/architecture.md."""
import importlib.machinery
import importlib.util
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "scripts" / "cost_of_adding"
sys.dont_write_bytecode = True
loader = importlib.machinery.SourceFileLoader("cost_of_adding", str(SCRIPT))
cost = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
sys.modules[loader.name] = cost
loader.exec_module(cost)

# New files and edited ones, at most.
USUAL, LIMITS = (2, 3), {"accelerator": (4, 4)}
SOUND = "name: thing\ncompile: src/a.cpp\n\n@ new src/b.h\nb\n@ edit src/a.cpp\none\n@ with\none\ntwo\n"


def run(*arguments):
    return subprocess.run([sys.executable, SCRIPT, *arguments], text=True, capture_output=True)


class CostOfAdding(unittest.TestCase):
    def read(self, text):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "thing.txt"
            path.write_text(text)
            return cost.read_addition(path)

    def refuse(self, text, message):
        with self.assertRaisesRegex(cost.AdditionError, message):
            self.read(text)

    def test_all_apply_and_the_page_has_the_table(self):
        done = run("--check")
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_each_costs_what_it_may(self):
        additions = cost.read_additions()
        self.assertGreaterEqual(len(additions), 10)
        for addition in additions:
            with self.subTest(addition.id):
                new, edited = LIMITS.get(addition.id, USUAL)
                self.assertLessEqual(len(addition.new), new)
                self.assertLessEqual(len(addition.edited()), edited)

    def test_each_names_what_a_compiler_checks(self):
        for addition in cost.read_additions():
            with self.subTest(addition.id):
                self.assertTrue(addition.compiled)
                for file in addition.compiled:
                    self.assertTrue(file in addition.new or (ROOT / file).is_file(), file)
                new_units = {file for file in addition.new if file.endswith(".cpp")}
                self.assertLessEqual(new_units, set(addition.compiled))

    def test_counting(self):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            (root / "src").mkdir()
            (root / "src" / "a.cpp").write_text("zero\none\nthree\n")
            addition = self.read(SOUND)
            texts = cost.changed_files(addition, root)
            self.assertEqual(texts, {"src/a.cpp": "zero\none\ntwo\nthree\n", "src/b.h": "b\n"})
            self.assertEqual(cost.row(addition, root), "thing | 1 | 1 | 1 | `a.cpp`")
            (root / "src" / "a.cpp").write_text("one\none\n")
            with self.assertRaisesRegex(cost.AdditionError, "a.cpp has 2 times, expected once"):
                cost.changed_files(addition, root)
            (root / "src" / "b.h").write_text("")
            (root / "src" / "a.cpp").write_text("one\n")
            with self.assertRaisesRegex(cost.AdditionError, "there is a src/b.h already"):
                cost.changed_files(addition, root)

    def test_refusals(self):
        self.refuse(SOUND.replace("name: thing\n", ""), "expected a name")
        self.refuse("name: thing\n", "expected a name, and files or edits")
        self.refuse("word\n" + SOUND, "'word': expected name: or compile:")
        self.refuse(SOUND + "@ with\nthree\n", "expected @ with after each @ edit alone")
        self.refuse(SOUND + "@ edit src/a.cpp\none\n", "each with its end")
        self.refuse(SOUND + "@ drop src/a.cpp\n", "expected new, edit, with or check")
        done = run("no_such_thing")
        self.assertEqual(done.returncode, 1)
        self.assertIn("no addition no_such_thing; expected some of accelerator, aov", done.stderr)

    def test_help_is_the_text_as_it_stands(self):
        done = run("--help")
        self.assertEqual(done.returncode, 0)
        self.assertEqual(done.stdout.strip(), cost.__doc__.strip())


if __name__ == "__main__":
    unittest.main()
