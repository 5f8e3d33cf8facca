"""Scene files as further arguments of an experiment."""
import dataclasses
import shlex
import sys
from pathlib import Path

from lib.description import HarnessError


def add_scene_files(parser):
    """An experiment's `add_arguments`."""
    parser.add_argument("--scenes", nargs="*", default=[], metavar="FILE",
                        help="scene files to measure besides the built-in scenes; of a Python file "
                             "(.py) the ptexp.Scene in its variable `scene`")


def scene_files(arguments):
    """Each configuration runs in a folder of its own: only whole paths lead anywhere."""
    return [str(Path(path).resolve()) for path in arguments.scenes]


def by_python(configuration):
    """The configuration; where its scene is made in memory by a Python file, python_scene.py renders
    it instead of ptexp. Raises HarnessError where that cannot be."""
    words = shlex.split(configuration.arguments)
    scene = next((scene for name, scene in zip(words, words[1:]) if name == "--scene"), "")
    if not configuration.renders or not scene.endswith(".py"):
        return configuration
    if configuration.program:
        raise HarnessError(f"{scene}: expected a scene file that ptexp reads, since the experiment names the program")
    return dataclasses.replace(configuration, launcher=f"{configuration.launcher} {shlex.quote(sys.executable)}".strip(),
                               program=str(Path(__file__).with_name("python_scene.py")))


def short_name(scene):
    """Of a file, its folder's name and its own; a built-in scene's name stays."""
    return "/".join(Path(scene).parts[-2:])
