"""Packaging: recipes of containers, which CI cannot build; one version everywhere; what a build says
that lacks packages; releases and the licences of wheels, with builds that are planted.

The recipes install what scripts/common.sh installs to build, use presets that exist, and copy between
stages that exist. hadolint judges the Dockerfile in .ci/run.
"""
import base64
import hashlib
import importlib.machinery
import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import unittest
import zipfile
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
DOCKERFILE = (ROOT / "packaging" / "Dockerfile").read_text("utf-8")
APPTAINER = (ROOT / "packaging" / "ptexp.def").read_text("utf-8")
# For tests, the Python module, and for building again.
NOT_TO_BUILD = {"ccache", "python3", "python3-dev", "python3-venv", "python3-pip", "libgtest-dev"}


def installed(text):
    """The packages of each apt-get install."""
    joined = text.replace("\\\n", " ")
    lists = re.findall(r"apt-get install ([^&\n]*)", joined)
    return [{word for word in words.split() if not word.startswith("-")} for words in lists]


def needed():
    text = (ROOT / "scripts" / "common.sh").read_text("utf-8")
    packages = re.search(r"ptexp_packages=\((.*?)\)", text, re.DOTALL).group(1)
    return set(packages.split()) - NOT_TO_BUILD


def script(name):
    """A script of scripts/ as a module, whatever its ending."""
    path = str(ROOT / "scripts" / name)
    loader = importlib.machinery.SourceFileLoader(Path(name).stem, path)
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


class Versions(unittest.TestCase):
    def test_one_version_everywhere(self):
        def found(path, pattern):
            return re.findall(pattern, (ROOT / path).read_text("utf-8"))
        version, = found("CMakeLists.txt", r"project\(ptexp VERSION ([0-9.]+) ")
        self.assertEqual(found("CITATION.cff", r"(?m)^version: (.*)$"), [version])
        self.assertEqual(set(found("docs/install.md", r"ptexp[_-]([0-9]+\.[0-9.]+[0-9])")), {version})
        self.assertEqual(found("packaging/Dockerfile", r"image\.version=(.*)"), 2 * [version])
        self.assertEqual(found("packaging/ptexp.def", r"(?m)^ +Version (.*)$"), [version])
        # The newest of the changes, of the day that citations name.
        (newest, date), *_ = found("CHANGELOG.md", r"(?m)^## ([0-9.]+) \((\S+)\)$")
        self.assertEqual(newest, version)
        self.assertEqual(found("CITATION.cff", r"(?m)^date-released: (.*)$"), [date])
        # pip asks CMakeLists.txt.
        pattern, = found("pyproject.toml", r"metadata.version.regex = '(.*)'")
        self.assertEqual(found("CMakeLists.txt", pattern), [version])


class Needs(unittest.TestCase):
    """What cmake, and so pip, says where packages are missing."""

    def configure(self, *options, path=os.environ["PATH"]):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run(["cmake", "-S", ROOT, "-B", folder, "-GNinja", "-DPTEXP_CUDA=OFF",
                                   *options], capture_output=True, text=True, check=False,
                                  env={**os.environ, "PATH": path})
        self.assertNotEqual(done.returncode, 0)
        lines = [line for line in done.stderr.splitlines() if "apt-get install" in line]
        self.assertEqual(len(lines), 1, done.stderr)
        return lines[0].partition("apt-get install ")[2].split()

    def test_all_that_is_missing_is_one_line(self):
        self.assertEqual(self.configure("-DCMAKE_DISABLE_FIND_PACKAGE_glm=ON",
                                        "-DCMAKE_DISABLE_FIND_PACKAGE_PNG=ON",
                                        "-DPTEXP_STB_INCLUDE="),
                         ["libglm-dev", "libpng-dev", "libstb-dev"])

    def test_without_a_compiler_all_packages(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("cmake", "ninja"):
                Path(folder, name).symlink_to(shutil.which(name))
            missing = self.configure(path=folder)
        self.assertLessEqual({"build-essential", "libglm-dev", "libtinygltf-dev"}, set(missing))
        self.assertLessEqual(set(missing), needed())
        text = (ROOT / "cmake" / "Needs.cmake").read_text("utf-8")
        named = set(re.findall(r"(?m)^ptexp_need(?:_header)?\(.* (\S+)\)$", text))
        # The others serve optional parts, or what every build machine has.
        self.assertEqual(needed() - named, {"build-essential", "cmake", "ninja-build", "git",
                                            "libembree-dev", "libcpp-httplib-dev",
                                            "libnanovdb-dev", "libblosc-dev"})


class Releases(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="ptexp release ")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name) / "releases" / "new"
        self.release = script("release")
        self.release.make_wheel = lambda folder: (folder / "a.whl").write_bytes(b"wheel")
        self.release.make_package = lambda folder: (folder / "a.deb").write_bytes(b"package")
        self.release.compiler = lambda: "planted 1.2"
        self.release.check_tree = lambda: "abc"

    def test_a_folder_with_all_that_is_true_of_it(self):
        self.release.make_release(self.folder)
        version, archive = self.release.version(), next(self.folder.glob("*.tar.gz"))
        self.assertEqual({path.name for path in self.folder.iterdir()}, {
            "a.whl", "a.deb", archive.name, "provenance.json", "SHA256SUMS"})
        subprocess.run(["sha256sum", "--check", "--strict", "--quiet", "SHA256SUMS"], check=True,
                       cwd=self.folder)
        facts = json.loads((self.folder / "provenance.json").read_text("utf-8"))
        commit, time = self.release.read("git", "log", "-1", "--format=%H %cI").split()
        self.assertEqual([facts[key] for key in ("version", "commit", "commit_time", "compiler")],
                         [version, commit, time, "planted 1.2"])
        self.assertEqual(facts["files"]["a.deb"], {
            "bytes": 7, "sha256": hashlib.sha256(b"package").hexdigest()})
        with tarfile.open(archive) as files:
            inside = files.extractfile(f"ptexp-{version}/cmake/archive_commit.txt").read().decode()
            self.assertIn(f"ptexp-{version}/src/main.cpp", files.getnames())
        # What a build of the archive says of itself.
        self.assertEqual(inside.split()[0], commit)
        before = archive.read_bytes()
        self.release.make_archive(self.folder)
        self.assertEqual(archive.read_bytes(), before)
        with self.assertRaisesRegex(ValueError, "exists; expected a new folder"):
            self.release.make_release(self.folder)

    def test_nothing_is_left_of_one_that_fails(self):
        def fail(_):
            raise ValueError("no room")
        self.release.make_archive = self.release.make_wheel
        with mock.patch.object(self.release, "check_tree", iter(["abc", "def"]).__next__):
            with self.assertRaisesRegex(ValueError, "HEAD has moved from abc"):
                self.release.make_release(self.folder)
        self.assertEqual(list(self.folder.parent.iterdir()), [])
        for step in ("make_package", "write_sums"):
            with mock.patch.object(self.release, step, fail):
                with self.assertRaisesRegex(ValueError, "no room"):
                    self.release.make_release(self.folder)
            self.assertEqual(list(self.folder.parent.iterdir()), [])

    def test_what_is_not_committed_or_described_is_no_release(self):
        fresh = script("release")
        with mock.patch.object(fresh, "read", lambda *_: " M src/main.cpp\n?? a"):
            with self.assertRaisesRegex(ValueError, "^M src/main.cpp: expected a tree without"):
                fresh.check_tree()
        with mock.patch.object(fresh, "read", lambda *_: ""):
            fresh.check_tree()
            with mock.patch.object(fresh, "version", lambda: "9.9.9"):
                with self.assertRaisesRegex(ValueError, "CHANGELOG.md: expected a heading '## 9.9.9'"):
                    fresh.check_tree()


class Licences(unittest.TestCase):
    def test_a_wheel_has_those_of_all_that_it_contains(self):
        script_of = script("wheel_licences.py")
        script_of.package_of = lambda library: re.match(r"[^-]*", Path(library).name)[0]
        script_of.copyright_of = lambda package: f"licence of {package}".encode()
        script_of.nanobind_licences = lambda: {"nanobind/LICENSE": b"BSD"}
        info = "ptexp-1.dist-info"
        with tempfile.TemporaryDirectory() as folder:
            wheel = Path(folder, "a.whl")
            with zipfile.ZipFile(wheel, "w") as archive:
                for name, text in (("ptexp/_ptexp.so", "code"), ("ptexp.libs/libpng16-0a.so.1", "png"),
                                   ("ptexp.libs/libblosc-0a.so.1", "blosc"), ("ptexp.libs/", ""),
                                   (f"{info}/METADATA", "Name: ptexp\nLicense-File: LICENSE\n\ntext\n"),
                                   (f"{info}/licenses/LICENSE", "MIT"), (f"{info}/RECORD", "old")):
                    archive.writestr(name, text)
            script_of.add_licences(wheel)
            with zipfile.ZipFile(wheel) as archive:
                content = {name: archive.read(name) for name in archive.namelist()}
        packages = ["libblosc", "libpng16", *script_of.HEADERS, script_of.NANOVDB]
        for package in packages:
            name = f"third_party/{package}/copyright"
            self.assertEqual(content[f"{info}/licenses/{name}"], f"licence of {package}".encode())
            self.assertIn(f"\nLicense-File: {name}\n", content[f"{info}/METADATA"].decode())
        self.assertTrue(content[f"{info}/METADATA"].endswith(b"\n\ntext\n"))
        self.assertEqual(content["ptexp/_ptexp.so"], b"code")
        recorded = [line.rsplit(",", 2) for line in content[f"{info}/RECORD"].decode().splitlines()]
        self.assertEqual({name for name, *_ in recorded}, {*content} - {"ptexp.libs/"})
        for name, digest, size in recorded[:-1]:
            expected = base64.urlsafe_b64encode(hashlib.sha256(content[name]).digest()).decode()
            self.assertEqual((digest, int(size)), ("sha256=" + expected.rstrip("="), len(content[name])))

    @unittest.skipUnless(shutil.which("dpkg-query"), "no Debian")
    def test_libraries_are_found_by_the_names_that_auditwheel_gives(self):
        script_of = script("wheel_licences.py")
        library = next(Path("/usr/lib").glob("*/libpng16.so.*.*.*")).name
        renamed = library.replace(".so", "-0123abcd.so", 1)
        self.assertRegex(script_of.package_of(f"ptexp.libs/{renamed}"), "^libpng16")
        with self.assertRaisesRegex(ValueError, "no Debian package here has libnothing.so.1"):
            script_of.package_of("ptexp.libs/libnothing-0123abcd.so.1")
        with self.assertRaisesRegex(ValueError, "/usr/share/doc/nothing/copyright: no such file"):
            script_of.copyright_of("nothing")


class Containers(unittest.TestCase):
    def test_install_what_building_needs(self):
        lists = installed(DOCKERFILE) + installed(APPTAINER)
        self.assertEqual(len(lists), 3)
        for packages in lists:
            self.assertLessEqual(needed(), packages)

    def test_presets_exist(self):
        presets = json.loads((ROOT / "CMakePresets.json").read_text("utf-8"))
        for kind in ("configurePresets", "buildPresets"):
            names = {preset["name"] for preset in presets[kind]}
            for text in (DOCKERFILE, APPTAINER):
                used = set(re.findall(r"--preset (\S+)", text))
                self.assertTrue(used)
                self.assertLessEqual(used, names)

    def test_stages_exist(self):
        stages = re.findall(r"(?m)^FROM \S+ AS (\S+)$", DOCKERFILE)
        self.assertEqual(stages, ["build-cpu", "build-cuda", "cpu", "cuda"])
        for source in re.findall(r"--from=(\S+)", DOCKERFILE):
            self.assertIn(source, stages)
        stages = re.findall(r"(?m)^Stage: (\S+)$", APPTAINER)
        self.assertEqual(re.findall(r"(?m)^%files from (\S+)$", APPTAINER), stages[:1])

    def test_both_have_the_same_code_for_gpus(self):
        codes = [re.findall(r'CMAKE_CUDA_ARCHITECTURES=([^"]*)', text)
                 for text in (DOCKERFILE, APPTAINER)]
        self.assertEqual(codes[0], codes[1])
        self.assertEqual(len(codes[0]), 1)

    def test_the_page_names_targets_that_exist(self):
        page = (ROOT / "docs" / "install.md").read_text("utf-8")
        for target in re.findall(r"--target (\S+)", page):
            self.assertIn(f" AS {target}\n", DOCKERFILE)
        for path in re.findall(r"\b(packaging/[\w.]+|tests/scripts/[\w.]+)", page):
            self.assertTrue((ROOT / path).is_file(), path)


if __name__ == "__main__":
    unittest.main()
