"""What shells complete, and the man page, against --help-all: the same options, no more and no fewer.

The environment variable PTEXP names the executable (build/release/src/ptexp). Shells and checkers
that are not installed skip.
"""
import os
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PTEXP = Path(os.environ.get("PTEXP", ROOT / "build" / "release" / "src" / "ptexp")).resolve()
RENDERS = ("resume", "verify", "view", "advise")  # these take the program's options, too


def ptexp(*arguments):
    return subprocess.run([PTEXP, *arguments], capture_output=True, text=True, check=True,
                          timeout=60).stdout


def flags_of_help(*command):
    """Those in the first column of a help; of the program, of all options."""
    flags = set()
    for line in ptexp(*command, "--help" if command else "--help-all").splitlines():
        match = re.match(r"  (-\S+)", line)
        flags.update(match.group(1).split(",") if match else [])
    return flags


def subcommands_of_help():
    names = ptexp("--help").partition("\nSubcommands:\n")[2].partition("\n\n")[0]
    return set(re.findall(r"(?m)^  (\S+)", names))


def expected_flags(command):
    if not command:
        return flags_of_help()
    program = flags_of_help() if command in RENDERS else set()
    return flags_of_help(command) | program


def write_script(folder, shell, name):
    path = Path(folder) / name
    path.write_text(ptexp("--completion", shell), encoding="utf-8")
    return path


class Help(unittest.TestCase):
    def test_is_read_as_it_is_printed(self):  # else sets that are empty are equal
        self.assertLessEqual({"-o", "--output", "--mode", "-h", "--help", "--completion"},
                             flags_of_help())
        self.assertEqual(flags_of_help("compare"), {"-h", "--help", "--tolerance", "--difference"})
        self.assertLessEqual({"trace", "merge", "doctor", "compare"}, subcommands_of_help())


class Completion:
    """Completion by one shell: complete(words) lists what it offers for the last of them."""
    shell = ""

    def setUp(self):
        if not shutil.which(self.shell):
            self.skipTest(f"{self.shell} is not installed")
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        (self.folder / "my image.exr").touch()

    def assert_flags(self, command, offered):
        self.assertEqual({word for word in offered if word.startswith("-")},
                         expected_flags(command), command)

    def test_options_are_those_of_the_help(self):
        for command in ("", *sorted(subcommands_of_help())):
            with self.subTest(command=command):
                self.assert_flags(command, self.complete_flags(command))

    def test_subcommands(self):
        self.assertLessEqual(subcommands_of_help(), set(self.complete("")))

    def test_values(self):
        self.assertEqual(set(self.complete("--mode", "")), {"auto", "serial", "megakernel", "wavefront"})
        self.assertEqual(set(self.complete("--device", "c")), {"cpu", "cuda"})
        self.assertIn("cornell", self.complete("--scene", "co"))
        self.assertEqual(set(self.complete("compact", "--cache", "")), {"cold", "warm"})
        self.assertEqual(set(self.complete("resume", "--mode", "s")), {"serial"})

    def test_files(self):
        self.assertEqual(self.complete("--output", "my"), ["my image.exr"])
        self.assertEqual(self.complete("compare", "my"), ["my image.exr"])


class Bash(Completion, unittest.TestCase):
    shell = "bash"

    def complete(self, *words):
        script = write_script(self.folder, "bash", ".ptexp")
        code = ('source "$1"; shift; COMP_WORDS=(ptexp "$@"); COMP_CWORD=$#\n_ptexp\n'
                'for word in "${COMPREPLY[@]}"; do printf "%s\\n" "$word"; done')
        return subprocess.run(["bash", "-uc", code, "_", script, *words], capture_output=True,
                              text=True, check=True, cwd=self.folder).stdout.splitlines()

    def complete_flags(self, command):
        return self.complete(*filter(None, [command]), "-")

    def test_values_behind_an_equals_sign(self):
        self.assertEqual(self.complete("--mode", "="), ["auto", "serial", "megakernel", "wavefront"])
        self.assertEqual(self.complete("--mode", "=", "w"), ["wavefront"])

    def test_has_no_complaint_of_shellcheck(self):
        if not shutil.which("shellcheck"):
            self.skipTest("shellcheck is not installed")
        script = write_script(self.folder, "bash", "ptexp.bash")
        run = subprocess.run(["shellcheck", "--shell=bash", script], capture_output=True, text=True,
                             check=False)
        self.assertEqual((run.returncode, run.stdout), (0, ""))


class Fish(Completion, unittest.TestCase):
    shell = "fish"

    def complete(self, *words):
        script = write_script(self.folder, "fish", "ptexp.fish")
        line = " ".join(["ptexp", *words])
        code = 'source $argv[1]; complete --do-complete $argv[2]'
        run = subprocess.run(["fish", "--no-config", "-c", code, script, line], capture_output=True,
                             text=True, check=True, cwd=self.folder,
                             env={**os.environ, "HOME": str(self.folder)})
        offered = [row.partition("\t")[0] for row in run.stdout.splitlines()]
        return [word.replace("\\ ", " ") for word in offered]

    def complete_flags(self, command):
        line = [*filter(None, [command])]
        return {*self.complete(*line, "-"), *self.complete(*line, "--")}


class Zsh(unittest.TestCase):
    """By a terminal of its own (zpty) one sees no list; what _arguments is told is as good."""

    def arguments(self, command):
        """The options that _arguments is told of, or all that it is told."""
        code = ('_describe() { :; }\n_arguments() { print -rl -- "${(@)@}"; state=argument; '
                'words=("$command"); return 1; }\ncommand=$2\n. $1; true')
        with tempfile.TemporaryDirectory() as folder:
            script = write_script(folder, "zsh", "_ptexp")
            run = subprocess.run(["zsh", "-fc", code, "_", script, command], capture_output=True,
                                 text=True, check=True)
        self.assertEqual(run.stderr, "")
        return run.stdout.splitlines()

    def setUp(self):
        if not shutil.which("zsh"):
            self.skipTest("zsh is not installed")

    @staticmethod
    def flags(lines):
        return {match.group(1) for line in lines
                if (match := re.match(r"\*(-[\w-]+)=?\[", line))}

    def test_options_are_those_of_the_help(self):
        program = self.arguments("")
        self.assertEqual(self.flags(program), expected_flags(""))
        for command in sorted(subcommands_of_help()):
            with self.subTest(command=command):
                lines = self.arguments(command)
                self.assertEqual(lines[:len(program)], program)
                self.assertEqual(self.flags(lines[len(program):]), expected_flags(command))

    def test_values(self):
        lines = self.arguments("")
        mode = next(line for line in lines if line.startswith("*--mode="))
        self.assertTrue(mode.endswith(":(auto serial megakernel wavefront)"), mode)
        scene = next(line for line in lines if line.startswith("*--scene="))
        self.assertRegex(scene, r":NAME\|FILE: _ptexp_word_or_file .*\bcornell\b")


class ManPage(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.page = Path(folder.name) / "ptexp.1"
        self.page.write_text(ptexp("--reference", "man"), encoding="utf-8")

    def check(self, *command):
        if not shutil.which(command[0]):
            self.skipTest(f"{command[0]} is not installed")
        run = subprocess.run([*command, self.page], capture_output=True, text=True, check=False,
                             env={**os.environ, "LC_ALL": "C.UTF-8", "MANWIDTH": "80"})
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        return run.stdout

    def test_mandoc_has_no_complaint(self):
        self.assertEqual(self.check("mandoc", "-Tlint"), "")

    def test_man_shows_every_option_of_the_help(self):
        text = self.check("man", "--warnings", "--local-file")
        text = re.sub(r".\x08", "", text)
        for command in ("", *sorted(subcommands_of_help())):
            for flag in flags_of_help(*filter(None, [command])):
                self.assertRegex(text, rf"(?m)^ +(-\w, )?{flag}\b", command)


class Markdown(unittest.TestCase):
    def test_has_a_heading_for_every_option_of_the_help(self):
        page = ptexp("--reference", "markdown")
        headings = re.findall(r"(?m)^### `(.*)` \{#\S+\}$", page)
        flags = {flag for heading in headings for flag in re.findall(r"(?:^|`)(-[\w-]+)", heading)}
        expected = set().union(*map(expected_flags, ["", *subcommands_of_help()]))
        self.assertEqual(flags, expected)
        anchors = re.findall(r"\{#(\S+)\}", page)
        self.assertEqual(len(anchors), len(set(anchors)))


if __name__ == "__main__":
    unittest.main()
