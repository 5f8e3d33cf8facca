#!/usr/bin/env python3
"""Checks the includes and conditionals below src/ against the rules of the architecture.

Usage: check_layers.py [SRC]     SRC is the repository's src/ folder unless given

Prints FILE:LINE and the rule broken, and exits with 1, for every breach. The rules are the tables
below; a new folder or a new permission is a line in one of them. Where all are kept, folders are
checked as well: none includes another one that includes it, over however many others.
"""
import fnmatch
import re
import sys
from pathlib import Path

# Who may include whom: layer, the files in it (the first pattern that fits counts; * spans
# folders), and the layers that it may include besides itself.
PLAIN = ["platform", "choices"]
MATHS = ["math", *PLAIN]
SAMPLING = ["sampling", *MATHS]
SHAPES = ["geometry", *SAMPLING]
SCENE_PARTS = ["light", "material", "medium", "texture", "accel", *SHAPES]
HOST = ["options", "error"]
BUILDERS = ["build", "embree", *SCENE_PARTS, *HOST]
SCENE = ["loaders", "builtin", "prepare", "scene", "plan", "image", *BUILDERS]
PHYSICS = ["transport", "prepare", "scene", *SCENE_PARTS]
COMMON = ["rays", "block_wavefront", "device", "build_cuda", "cuda", "render", "film", "trace_cuda", "optix",
          "transport", *SCENE]
SCHEDULES = ["serial", "megakernel", "wavefront"]

LAYERS = [
    # The Python module, which is given what the program is.
    ("python", ["python/*"], ["app", "edit", "distribute", *SCHEDULES, *COMMON]),
    # The page of a render in progress.
    ("view", ["view/*"], ["app", "edit", *SCHEDULES, *COMMON]),
    # The program: commands, the command line, reports.
    ("app", ["app/*"], ["mpi", "distribute", *SCHEDULES, *COMMON]),
    # Processes of one job, whose devices work for the first one.
    ("mpi", ["common/mpi/*"], ["distribute", "film", "options", "error"]),
    # Several renderers as one: who gets which pixels.
    ("distribute", ["common/distribute/*"], ["render", "film", "image", "plan", *PHYSICS, *HOST]),
    # Schedules. None includes another one.
    *[(name, [name + "/*"], COMMON) for name in SCHEDULES],
    # Arrays of rays: files of them, and the kernels that measure how fast they are traced.
    ("rays", ["common/rays/*"], ["build_cuda", "cuda", "render", "trace_cuda", "transport", *SCENE]),
    # The wavefront inside of a block, which the megakernel runs by and the wavefront ends with.
    ("block_wavefront", ["common/block_wavefront/*"],
     ["device", "cuda", "render", "film", "trace_cuda", "transport", *SCENE]),
    # What runs a schedule on a device.
    ("device", ["common/device/*"], ["build_cuda", "cuda", "render", "film", "transport", *SCENE]),
    # Around the physics: renderers and batches; what becomes of the samples.
    ("render", ["common/render/*"], ["film", "image", "plan", *PHYSICS, *HOST]),
    ("film", ["common/film/*"], ["image", *PHYSICS, *HOST]),
    # Scene files. A small picture of a model tells whether it is lit.
    ("loaders", ["common/scene/load/*"], ["transport", "builtin", "prepare", "scene", "image", *SCENE_PARTS, *HOST]),
    # Physics, which knows no device, film or renderer.
    ("transport", ["common/transport/*"], ["scene", *SCENE_PARTS]),
    # Scene data, made in code, is prepared for tracing as the plan says.
    ("builtin", ["common/scene/builtin/*"], ["prepare", "scene", *BUILDERS]),
    ("prepare", ["common/scene/prepare/*"], ["scene", "plan", "image", *BUILDERS]),
    # What of a scene can be changed, by name.
    ("edit", ["common/scene/edit/*"], ["scene", *SCENE_PARTS, *HOST]),
    ("scene", ["common/scene/data/*"], ["plan", "image", *BUILDERS]),
    # What options leave open is decided here, from facts of the scene and the device.
    ("plan", ["common/plan/*"], BUILDERS),
    ("image", ["common/image/*"], HOST),
    # Acceleration structures: what rays pass through, how it is built, and warps that persist.
    ("build_cuda", ["common/accel/build_cuda/*"], ["cuda", "build", *SCENE_PARTS, *HOST]),
    ("trace_cuda", ["common/accel/trace_cuda/*"], ["accel", *SHAPES]),
    # What OptiX is told and runs, on a GPU or, in tests, on the host.
    ("optix", ["common/accel/trace_optix/*"], ["cuda", "accel", *SHAPES, *HOST]),
    ("embree", ["common/accel/embree/*"], ["build", "accel", *SHAPES, *HOST]),
    ("build", ["common/accel/build/*"], ["accel", *SHAPES, *HOST]),
    ("accel", ["common/accel/*"], [*SHAPES, *HOST]),
    ("light", ["common/light/*"], ["material", "texture", "error", *SHAPES]),
    ("material", ["common/material/*"], ["texture", *SHAPES]),
    ("medium", ["common/medium/*"], SHAPES),
    ("texture", ["common/texture/*"], MATHS),
    ("geometry", ["common/geometry/*"], SAMPLING),
    ("sampling", ["common/sampling/*"], [*MATHS, "error"]),
    ("math", ["common/math/*"], PLAIN),
    # Calls of CUDA and its memory.
    ("cuda", ["common/cuda/*"], HOST),
    # Plain data that the user chooses and that is measured.
    ("options", ["common/options/*"], ["choices"]),
    # What options choose from, for code that knows no options.
    ("choices", ["common/choices/*"], ["platform"]),
    ("error", ["common/error/*"], []),
    ("platform", ["common/platform/*"], []),
]
MAIN = "main"  # main.cpp, alone in src/
MAIN_MAY_INCLUDE = ["view", "app", "mpi", "distribute", *SCHEDULES, *COMMON]

# Who may know CUDA.
CUDA_HEADER = re.compile(
    r"(cuda|curand|cublas|cufft|cusolver|cusparse|cupti|nvtx|nvToolsExt|nvml|nvrtc|nvPTXCompiler|"
    r"nv/|cccl/|cooperative_groups|mma\.h|crt/|device_launch_parameters|vector_types|"
    r"vector_functions|driver_types|math_constants|sm_\d)")
CUB_HEADER = re.compile(r"(cub|thrust)/")
CUDA_FILES = ["*.cu", "*.cuh", "*_cuda.*"]
CUB_FILES = ["*compaction_cuda.cu", "common/accel/build_cuda/*.cu"]
PLATFORM = "common/platform/platform.h"
PLATFORM_CUDA_HEADERS = ["cuda.h", "cuda_runtime.h", "cuda_runtime_api.h"]  # GLM needs them

# Who may know MPI: a program without it lacks these files.
MPI_HEADER = re.compile(r"mpi(cxx|-ext|_proto)?\.h$")
MPI_FILES = ["common/mpi/*_mpi.*"]

# Who may know HTTP, likewise.
HTTP_HEADER = re.compile(r"httplib\.h$")
HTTP_FILES = ["view/*_http.*"]

# Who may be compiled differently with and without CUDA.
COMPILER_CONDITION = re.compile(r"\b(__CUDACC\w*|__CUDA_ARCH\w*|__CUDA__|__NVCC__|CUDA_VERSION)\b")
BUILD_CONDITION = re.compile(r"\bPTEXP_CUDA\b")
BUILD_CONDITION_FILES = ["app/render/make_renderer.cpp", "app/commands/compact_command.cpp",
                         "app/commands/trace_mesh.cpp",
                         "common/device/devices*.cpp"]

SOURCE_ENDINGS = {".h", ".hpp", ".cpp", ".cc", ".cu", ".cuh", ".inl"}
INCLUDE = re.compile(r"\s*#\s*include\b\s*(?:\"([^\"]*)\"|<([^>]*)>)?")
CONDITION = re.compile(r"\s*#\s*(?:if|ifdef|ifndef|elif|elifdef|elifndef)\b(.*)")
# What may hide a comment's beginning or end, a comment itself, or a continued line.
TOKEN = re.compile(r"""//(?:\\\n|[^\n])*|/\*.*?\*/|R"([^\s()\\]{0,16})\(.*?\)\1"|"""
                   r""""(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'|\\\n""", re.DOTALL)


def fits(path, patterns):
    return any(fnmatch.fnmatchcase(path, pattern) for pattern in patterns)


def layer_of(path):
    """The layer of a path below src/, or None."""
    if path == "main.cpp":
        return MAIN
    return next((name for name, patterns, _ in LAYERS if fits(path, patterns)), None)


def allowed(layer):
    if layer == MAIN:
        return MAIN_MAY_INCLUDE
    return next(may_include for name, _, may_include in LAYERS if name == layer)


def logical_lines(text):
    """Yields (line number, line) without comments and raw strings, continued lines joined."""
    def replace(match):
        token = match.group()
        if token == "\\\n":
            return "\v"  # one logical line that spans two
        if token.startswith(("//", "/*", "R")):
            return " " + "\v" * token.count("\n")
        return token
    number = 1
    for line in TOKEN.sub(replace, text).split("\n"):
        begin = len(line) - len(line.lstrip())
        yield number + line.count("\v", 0, begin), line.replace("\v", " ")
        number += 1 + line.count("\v")


def own_path(source, header, path):
    """The path below src/ of an included header of this project, or None for a library's."""
    for candidate in (source / header, (source / path).parent / header):
        if candidate.is_file():
            return candidate.resolve().relative_to(source).as_posix()
    return header if header.split("/")[0] in ["app", "common", "python", "view", *SCHEDULES] else None


def check_include(source, path, layer, quoted, angled):
    """Yields the rules that an #include breaks."""
    header = quoted or angled
    if not header:
        yield "an include is written out, not computed by a macro"
        return
    own = own_path(source, header, path)
    if own:
        if own != header:
            yield f"the project's headers are included by their path below src/: \"{own}\""
        if not quoted:
            yield "the project's headers are included in quotes"
        included = layer_of(own)
        if included is None:
            yield f"{own} lies in no layer"
        elif included != layer and included not in allowed(layer):
            yield (f"{layer} does not include {included} ({own}); "
                   f"it may include: {', '.join(allowed(layer)) or 'nothing of this project'}")
        if own.endswith((".cu", ".cpp")):
            yield f"{own} is compiled by itself and never included"
        elif own.endswith(".cuh") and not fits(path, CUDA_FILES):
            yield f"only CUDA files ({', '.join(CUDA_FILES)}) include a .cuh"
    elif quoted:
        yield f"no \"{header}\" below src/; a library's header is included in <>"
    elif CUB_HEADER.match(header):
        if not fits(path, CUB_FILES):
            yield f"only {', '.join(CUB_FILES)} include CUB: each such file takes long to compile"
    elif MPI_HEADER.match(header) and not fits(path, MPI_FILES):
        yield f"only {', '.join(MPI_FILES)} include MPI's headers"
    elif HTTP_HEADER.match(header) and not fits(path, HTTP_FILES):
        yield f"only {', '.join(HTTP_FILES)} include cpp-httplib"
    elif CUDA_HEADER.match(header) and not fits(path, CUDA_FILES):
        if path != PLATFORM:
            yield f"only CUDA files ({', '.join(CUDA_FILES)}) include CUDA's headers"
        elif header not in PLATFORM_CUDA_HEADERS:
            yield f"{PLATFORM} includes none of CUDA but {', '.join(PLATFORM_CUDA_HEADERS)}"


def check_condition(path, condition):
    """Yields the rules that an #if breaks."""
    if COMPILER_CONDITION.search(condition) and path != PLATFORM:
        yield (f"only {PLATFORM} asks which compiler runs; "
               "elsewhere a file is split by device, name_cpu.cpp and name_cuda.cu")
    if BUILD_CONDITION.search(condition) and not fits(path, BUILD_CONDITION_FILES):
        yield f"only {', '.join(BUILD_CONDITION_FILES)} ask whether CUDA is built in"


def check_file(source, path):
    """Yields (line number, rule broken) for a file, named by its path below src/."""
    layer = layer_of(path)
    if layer is None:
        yield 1, "lies in no layer: give its folder a line in scripts/check_layers.py"
        return
    for number, line in logical_lines((source / path).read_text(encoding="utf-8")):
        include = INCLUDE.match(line)
        condition = CONDITION.match(line)
        rules = ()
        if include:
            rules = check_include(source, path, layer, *include.groups())
        elif condition:
            rules = check_condition(path, condition.group(1))
        for rule in rules:
            yield number, rule


def folders_included(source, paths):
    """{folder: {folder that it includes: (path, line number) of the first such include}}"""
    graph = {}
    for path in paths:
        for number, line in logical_lines((source / path).read_text(encoding="utf-8")):
            include = INCLUDE.match(line)
            own = include and include.group(1) and own_path(source, include.group(1), path)
            if own and (source / own).parent != (source / path).parent:
                included = graph.setdefault(Path(path).parent.as_posix(), {})
                included.setdefault(Path(own).parent.as_posix(), (path, number))
    return graph


def find_circle(graph):
    """Folders of which each includes the next one and the last is the first, or None."""
    done = set()

    def search(folder, way):
        if folder in way:
            return [*way[way.index(folder):], folder]
        if folder in done:
            return None
        done.add(folder)
        circles = (search(included, [*way, folder]) for included in graph.get(folder, ()))
        return next(filter(None, circles), None)
    return next(filter(None, (search(folder, []) for folder in graph)), None)


def check_circle(source, paths):
    """Yields (path, line number, rule broken) where folders include each other in a circle."""
    graph = folders_included(source, paths)
    circle = find_circle(graph)
    if circle:
        yield (*graph[circle[-2]][circle[-1]],
               f"folders include each other in a circle: {' -> '.join(circle)}")


def main(arguments):
    if len(arguments) > 1 or arguments[:1] in (["-h"], ["--help"]):
        print(__doc__.strip())
        return 0 if len(arguments) == 1 else 2
    default = Path(__file__).resolve().parent.parent / "src"
    source = Path(arguments[0] if arguments else default).resolve()
    paths = sorted(file.relative_to(source).as_posix() for file in source.rglob("*")
                   if file.suffix in SOURCE_ENDINGS and file.is_file())
    if not paths:
        print(f"check_layers.py: no C++ or CUDA files below {source}", file=sys.stderr)
        return 2
    breaches = [(path, *breach) for path in paths for breach in check_file(source, path)]
    breaches = breaches or list(check_circle(source, paths))
    for path, number, rule in breaches:
        print(f"{source.name}/{path}:{number}: {rule}")
    print(f"{len(paths)} files checked, {len(breaches)} breaches of the layers")
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
