"""Tests scripts/check_layers.py with small source trees in which one breach is planted."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "check_layers.py"
sys.dont_write_bytecode = True
sys.path.insert(0, str(SCRIPT.parent))
import check_layers  # noqa: E402

SOUND = {
    "main.cpp": '#include "wavefront/wavefront.h"\n#include "app/render/make_renderer.h"\n',
    "app/render/make_renderer.h": '#include "common/render/renderer.h"\n',
    "app/render/make_renderer.cpp": "#ifdef PTEXP_CUDA\n#endif\n",
    "serial/serial.cpp": '#include "common/transport/shade.h"\n',
    "megakernel/trace_path.h": '#include "common/transport/shade.h"\n',
    "wavefront/wavefront.h": '#include "common/transport/shade.h"\n',
    "wavefront/compaction/compaction_cuda.cu": '#include <cub/cub.cuh>\n'
                                    '#include "common/device/launch.cuh"\n',
    "common/platform/platform.h": "#ifdef __CUDACC__\n#include <cuda.h>\n#include <cuda_runtime.h>\n#endif\n",
    "common/error/error.h": "#include <string>\n",
    "common/math/vec.h": '#include <glm/glm.hpp>\n#include "common/platform/platform.h"\n',
    "common/sampling/rng.h": '#include "common/math/vec.h"\n',
    "common/material/bsdf.h": '#include "common/sampling/rng.h"\n',
    "common/scene/data/scene.h": '#include "common/material/bsdf.h"\n',
    "common/transport/shade.h": '#include "common/scene/data/scene.h"\n',
    "common/accel/build_cuda/bvh.cu": '#include <cub/cub.cuh>\n'
                                      '#include "common/cuda/cuda_check.cuh"\n',
    "common/cuda/cuda_check.cuh": "#include <cuda_runtime.h>\n",
    "common/device/launch.cuh": "#include <cuda_runtime.h>\n",
    "common/device/devices.cpp": "#if defined(PTEXP_CUDA)\n#endif\n",
    "common/options/options.h": "#include <array>\n",
    "common/render/renderer.h": '#include "common/options/options.h"\n',
}


FOLDERS = {"scene": "scene/data", "prepare": "scene/prepare", "loaders": "scene/load"}


class CheckLayers(unittest.TestCase):
    def check(self, changed):
        """Runs the checker on the sound tree with `changed` files; returns (status, output)."""
        with tempfile.TemporaryDirectory() as folder:
            source = Path(folder, "src")
            for path, text in {**SOUND, **changed}.items():
                file = source / path
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(text, encoding="utf-8")
            run = subprocess.run([sys.executable, SCRIPT, source], capture_output=True, text=True,
                                 check=False, timeout=60)
        self.assertEqual(run.stderr, "")
        return run.returncode, run.stdout

    def assert_sound(self, changed):
        status, output = self.check(changed)
        self.assertEqual((status, output.count("\n")), (0, 1), output)

    def assert_breach(self, path, text, line, *words):
        """One breach, in `line` of `path`, whose text contains `words`."""
        status, output = self.check({path: text})
        self.assertEqual(status, 1, output)
        breaches = output.splitlines()[:-1]
        self.assertEqual(len(breaches), 1, output)
        self.assertTrue(breaches[0].startswith(f"src/{path}:{line}: "), output)
        for word in words:
            self.assertIn(word, breaches[0])

    def test_a_sound_tree_passes(self):
        self.assert_sound({})

    def test_the_table_has_no_cycle(self):
        reached = {name: set(may) for name, _, may in check_layers.LAYERS}
        for middle in reached:
            for below in reached.values():
                if middle in below:
                    below |= reached[middle]
        for name, below in reached.items():
            self.assertNotIn(name, below)

    def test_a_row_includes_rows_below_it_alone(self):
        names = [name for name, _, _ in check_layers.LAYERS]
        for place, (name, _, may) in enumerate(check_layers.LAYERS):
            if name not in check_layers.SCHEDULES:
                self.assertLessEqual(set(may), set(names[place + 1:]), name)

    def test_folders_do_not_include_each_other_in_a_circle(self):
        tree = {"common/material/x.h": '#include "common/material/a/x.h"\n',
                "common/material/a/x.h": '#include "common/material/b/x.h"\n',
                "common/material/b/x.h": '\n#include "common/material/bsdf.h"\n'}
        status, output = self.check(tree)
        self.assertEqual((status, output.count("\n")), (1, 2), output)
        self.assertIn("src/common/material/x.h:1: folders include each other in a circle: "
                      "common/material/a -> common/material/b -> common/material -> "
                      "common/material/a\n", output)
        self.assert_sound({**tree, "common/material/b/x.h": ""})

    def test_the_table_keeps_physics_from_devices_and_schedules_apart(self):
        for name in check_layers.PHYSICS + check_layers.SCHEDULES:
            may = set(check_layers.allowed(name))
            self.assertFalse(may & set(check_layers.SCHEDULES), name)
            if name in check_layers.PHYSICS:
                self.assertFalse(may & {"device", "render", "film", "build_cuda", "trace_cuda"}, name)

    def test_schedules_do_not_include_each_other(self):
        for a in check_layers.SCHEDULES:
            for b in check_layers.SCHEDULES:
                if a != b:
                    self.assert_breach(f"{a}/own.h", f'\n#include "{b}/other.h"\n', 2,
                                       f"{a} does not include {b}")

    def test_common_includes_no_schedule_and_no_app(self):
        self.assert_breach("common/render/renderer.h", '#include "wavefront/wavefront.h"\n', 1,
                           "render does not include wavefront")
        self.assert_breach("common/film/film.h", '#include "app/render/make_renderer.h"\n', 1,
                           "film does not include app")
        self.assert_breach("serial/serial.cpp", '#include "app/render/make_renderer.h"\n', 1,
                           "serial does not include app")

    def test_lower_physics_does_not_include_higher(self):
        for lower, higher in [("math", "sampling"), ("sampling", "geometry"),
                              ("geometry", "material"), ("material", "light"),
                              ("accel", "scene"), ("scene", "transport"), ("light", "scene")]:
            below, above = (FOLDERS.get(layer, layer) for layer in (lower, higher))
            self.assert_breach(f"common/{below}/x.h", f'#include "common/{above}/y.h"\n', 1,
                               f"{lower} does not include {higher}")

    def test_physics_includes_no_device(self):
        for layer in check_layers.PHYSICS:
            self.assert_breach(f"common/{FOLDERS.get(layer, layer)}/x.h",
                               '#include "common/device/devices.h"\n', 1,
                               f"{layer} does not include device")

    def test_only_cuda_files_include_cuda(self):
        for header in ["cuda.h", "cuda_runtime.h", "curand_kernel.h", "nvtx3/nvToolsExt.h",
                       "cooperative_groups.h", "cuda/std/atomic"]:
            self.assert_breach("common/device/x.cpp", f"#include <{header}>\n", 1, "CUDA")
            self.assert_sound({"common/device/x_cuda.cpp": f"#include <{header}>\n"})
        self.assert_breach("wavefront/x.h", '#include "common/device/launch.cuh"\n', 1, ".cuh")
        self.assert_breach("common/platform/platform.h", "#include <curand_kernel.h>\n", 1, "cuda.h")

    def test_few_files_include_cub(self):
        self.assert_breach("wavefront/wavefront_cuda.cu", "#include <cub/cub.cuh>\n", 1, "CUB")
        self.assert_breach("common/device/x.cuh", "#include <thrust/sort.h>\n", 1, "CUB")

    def test_only_mpi_files_include_mpi(self):
        self.assert_breach("common/mpi/ranks.cpp", "#include <mpi.h>\n", 1, "MPI")
        self.assert_breach("app/x_mpi.cpp", "#include <mpi.h>\n", 1, "MPI")
        self.assert_sound({"common/mpi/x_mpi.cpp": "#include <mpi.h>\n"})

    def test_only_http_files_of_the_view_include_http(self):
        self.assert_breach("view/site.cpp", "#include <httplib.h>\n", 1, "cpp-httplib")
        self.assert_breach("app/x_http.cpp", "#include <httplib.h>\n", 1, "cpp-httplib")
        self.assert_sound({"view/x_http.cpp": "#include <httplib.h>\n"})
        self.assert_breach("app/x.cpp", '#include "view/live_render.h"\n', 1, "app", "view")

    def test_one_file_asks_for_the_compiler(self):
        for condition in ["#ifdef __CUDACC__", "#ifndef __CUDA_ARCH__", "#if defined(__NVCC__)",
                          "#  if 1 && \\\n  defined(__CUDACC__)"]:
            self.assert_breach("common/math/x.h", f"\n{condition}\n#endif\n", 2, "platform.h")
        self.assert_breach("common/math/x.h", "#if 0\n#elif defined(__CUDA_ARCH__)\n#endif\n", 2,
                           "platform.h")

    def test_few_files_ask_for_the_build(self):
        self.assert_breach("wavefront/x.cpp", "#ifdef PTEXP_CUDA\n#endif\n", 1,
                           "make_renderer.cpp", "built in")
        self.assert_sound({"common/device/devices_all.cpp": "#ifdef PTEXP_CUDA\n#endif\n"})

    def test_includes_are_written_the_same_way(self):
        self.assert_breach("common/math/x.h", '#include "vec.h"\n', 1, '"common/math/vec.h"')
        self.assert_breach("common/sampling/x.h", '#include "../math/vec.h"\n', 1,
                           '"common/math/vec.h"')
        self.assert_breach("common/math/x.h", "#include <common/math/vec.h>\n", 1, "quotes")
        self.assert_breach("common/math/x.h", '#include "glm/glm.hpp"\n', 1, "<>")
        self.assert_breach("common/math/x.h", "#include HEADER\n", 1, "macro")
        self.assert_breach("main.cpp", '#include "app/render/make_renderer.cpp"\n', 1, "compiled by itself")

    def test_a_relative_path_does_not_hide_a_layer(self):
        status, output = self.check({"common/math/x.h": '#include "../scene/data/scene.h"\n'})
        self.assertEqual(status, 1)
        self.assertIn("math does not include scene", output)

    def test_an_unknown_folder_is_a_breach(self):
        self.assert_breach("common/helpers/x.h", "\n", 1, "lies in no layer")
        self.assert_breach("helper.cpp", "\n", 1, "lies in no layer")

    def test_comments_and_strings_are_not_code(self):
        self.assert_sound({"common/math/x.h": (
            "/*\n#include \"wavefront/wavefront.h\"\n*/\n"
            "// #include <cuda.h> \\\n#include <cuda.h>\n"
            "auto a = R\"(\n#include <cuda.h>\n)\";\n"
            "auto b = \"/*\";\nauto c = '\"';\n")})
        self.assert_breach("common/math/x.h", "/* a\nb */ #include <cuda.h> // why\n", 2, "CUDA")
        self.assert_breach("common/math/x.h", 'auto s = "/*";\n#include <cuda.h>\n', 2, "CUDA")
        self.assert_breach("common/math/x.h", "# include /* x */ <cuda.h>\n", 1, "CUDA")

    def test_an_empty_folder_is_an_error(self):
        with tempfile.TemporaryDirectory() as folder:
            run = subprocess.run([sys.executable, SCRIPT, folder], capture_output=True, text=True,
                                 check=False, timeout=60)
        self.assertEqual(run.returncode, 2)
        self.assertIn("no C++ or CUDA files", run.stderr)


if __name__ == "__main__":
    unittest.main()
