"""Counts of what src/ consists of, so that it does not grow back: files, folders, lines, and who
plans, who sees options. A change that needs more says so here."""

import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SRC = ROOT / "src"

FILES_MAX = 667
LINES_MAX = 89_147
FOLDER_FILES_MAX = 25
MEDIAN_LINES_MIN = 95
LOOP_LINES_MAX = 60


def sources(*folders):
    places = [SRC / folder for folder in folders] or [SRC]
    return [file for place in places for file in sorted(place.rglob("*")) if file.is_file()]


def code_of(file):
    """The text without comments and string literals."""
    text = file.read_text(encoding="utf-8")
    return re.sub(r'//[^\n]*|"(?:[^"\\\n]|\\.)*"', "", text)


class House(unittest.TestCase):
    def test_files_are_few_and_neither_tiny_nor_alone(self):
        files = sources()
        lines = sorted(len(file.read_text(encoding="utf-8").splitlines()) for file in files)
        self.assertLessEqual(len(files), FILES_MAX)
        self.assertLessEqual(sum(lines), LINES_MAX)
        self.assertGreaterEqual(lines[len(lines) // 2], MEDIAN_LINES_MIN)
        folders = {}
        for file in files:
            folders.setdefault(file.parent, []).append(file.name)
        for folder, names in folders.items():
            self.assertLessEqual(len(names), FOLDER_FILES_MAX, folder)
            self.assertGreater(len(names), 1, f"{folder}: a folder of one file")

    def test_a_render_is_planned_in_one_place(self):
        callers = {str(file.relative_to(SRC)): len(re.findall(r"\bplan_execution\(", code_of(file)))
                   for file in sources() if file.suffix in (".cpp", ".cu", ".cuh")}
        callers = {name: count for name, count in callers.items() if count}
        # Its definition, the program, and scenes that are prepared without one.
        self.assertEqual(callers, {"common/plan/execution_plan.cpp": 1,
                                   "app/render/make_renderer.cpp": 1,
                                   "common/scene/prepare/prepare_scene.cpp": 1})

    def test_what_runs_sees_the_plan_and_no_options(self):
        for file in sources("wavefront", "megakernel", "serial", "common/device", "common/render",
                            "common/distribute", "common/block_wavefront", "common/transport"):
            self.assertIsNone(re.search(r"\bOptions\b", code_of(file)), file)

    def test_who_uses_a_gpu_says_so_in_one_place(self):
        """Where a part of it (--sms) is known; others would use, and count, the whole."""
        def users(pattern):
            return {str(file.relative_to(SRC)) for file in sources()
                    if re.search(pattern, code_of(file))}
        self.assertEqual(users(r"\bcudaSetDevice\("),
                         {"common/cuda/used_gpu_cuda.cpp", "common/device/devices_cuda.cpp",
                          "app/doctor/cuda_facts_cuda.cu"})
        self.assertEqual(users("cudaDevAttrMultiProcessorCount"), {"common/cuda/used_gpu_cuda.cpp"})

    def test_the_loop_of_waves_is_one_screen(self):
        loop = (SRC / "wavefront" / "loop.h").read_text(encoding="utf-8").splitlines()
        self.assertLessEqual(len(loop), LOOP_LINES_MAX)


if __name__ == "__main__":
    unittest.main()
