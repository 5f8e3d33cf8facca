"""Scene files as further arguments of an experiment."""
import shlex
import sys
from pathlib import Path


def add_scene_files(parser):
    """An experiment's `add_arguments`."""
    parser.add_argument("--scenes", nargs="*", default=[], metavar="FILE",
                        help="scene files to measure besides the built-in scenes")


def scene_files(arguments):
    """Each configuration runs in a folder of its own: only whole paths lead anywhere."""
    return [str(Path(path).resolve()) for path in arguments.scenes]


def renderer_of(scene):
    """Of a Python file that makes its scene in memory: what renders it instead of ptexp, as a
    Configuration has it; of others nothing."""
    if not scene.endswith(".py"):
        return {}
    return {"launcher": shlex.quote(sys.executable), "program": str(Path(__file__).with_name("python_scene.py"))}


def short_name(scene):
    """Of a file, its folder's name and its own; a built-in scene's name stays."""
    return "/".join(Path(scene).parts[-2:])
