"""The recipes of containers, which CI cannot build: what they name must be there.

They install what scripts/common.sh installs to build, use presets that exist, and copy between
stages that exist. hadolint judges the Dockerfile in .ci/run.
"""
import json
import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
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
