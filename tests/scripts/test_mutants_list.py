"""The planted bugs of tests/mutants still apply to the sources, and the list is what it promises."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "scripts"))
import mutant_list  # noqa: E402


def write_tree(folder, entry, source):
    (Path(folder) / "list").mkdir()
    (Path(folder) / "src").mkdir()
    (Path(folder) / "list" / "a.txt").write_text(entry)
    (Path(folder) / "src" / "a.h").write_text(source)


class MutantsList(unittest.TestCase):
    def apply(self, entry, source):
        with tempfile.TemporaryDirectory() as folder:
            write_tree(folder, entry, source)
            mutants = mutant_list.read_mutants(Path(folder) / "list")
            return mutant_list.mutated_files(mutants, Path(folder) / "src")["a.h"]

    def refuse(self, entry, source, message):
        with self.assertRaisesRegex(mutant_list.ListError, message):
            self.apply(entry, source)

    def test_every_entry_applies(self):
        mutants = mutant_list.read_mutants(ROOT / "tests" / "mutants")
        mutant_list.mutated_files(mutants, ROOT / "src")
        self.assertGreaterEqual(len(mutants), 120)
        self.assertGreaterEqual(sum(m.is_device_only for m in mutants), 15)

    def test_help_is_the_text_as_it_stands(self):
        run = subprocess.run([sys.executable, ROOT / "scripts" / "mutants", "--help"], text=True,
                             capture_output=True, check=True)
        self.assertIn("ends with 1 where less than 95 % are caught. Tests that", run.stdout)

    def test_expressions_and_statements(self):
        number = mutant_list.zlib.crc32(b"one") | 1
        text = self.apply("# a comment\n[one] a.h\na bug\nbefore: a + b\nafter: a - b\n",
                          "#pragma once\nint f(int a, int b) { return a +\n b; }\n")
        self.assertEqual(text, f'#pragma once\n#include "{mutant_list.HEADER}"\nint f(int a, int b) '
                               f"{{ return (PT_MUTANT({number}u) ? (a - b) : (a +\n b)); }}\n")
        text = self.apply("[one] a.h\na bug\nbefore: ++i;\nafter:\n", "++i;\n")
        self.assertIn(f"{{ if (PT_MUTANT({number}u)) {{  }} else {{ ++i; }} }}", text)

    def test_what_does_not_apply_is_named(self):
        entry = "[one] a.h\na bug\nbefore: a + b\nafter: b\n"
        self.refuse(entry, "a - b", r"a.txt: \[one\] a.h: 'a \+ b' is there 0 times")
        self.refuse(entry, "a + b, a + b", "2 times")
        self.refuse(entry.replace("a.h", "b.h"), "a + b", "no such file")
        self.refuse(entry + "\n" + entry, "a + b", "taken")
        self.refuse(entry + "\n[two] a.h\na bug\nbefore: b + c\nafter: c\n", "a + b + c", "overlaps")
        self.refuse(entry.replace("a + b", "f(a"), "f(a)", "with both brackets")
        self.refuse(entry.replace("a + b", "b;"), "return a && b;", "a whole statement")
        self.refuse("[one] a.h\na bug\nbefor: a\nafter: b\n", "a", "'befor: a'")
        self.refuse("one a.h\na bug\nbefore: a\nafter: b\n", "a", "expected")

    def test_halves_of_expressions_and_declarations_are_named(self):
        for before in ("if (a) b", "a &&", "const int c = a", ".b(a)", "{a, b},"):
            self.refuse(f"[one] a.h\na bug\nbefore: {before}\nafter: a\n", before, "an expression, or")
        self.refuse("[one] a.h\na bug\nbefore: a\nafter:\n", "a", "an expression, or")
        self.refuse("[one] a.h\na bug\nbefore: const int c = a;\nafter: a;\n", "const int c = a;",
                    "declares nothing")

    def test_surroundings_choose_among_equal_ones(self):
        text = self.apply("[one] a.h\na bug\nwithin: g(a)\nbefore: a\nafter: b\n", "f(a); g(a);")
        self.assertTrue(text.endswith("? (b) : (a)));"), text)


if __name__ == "__main__":
    unittest.main()
