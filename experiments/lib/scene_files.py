"""Scene files as further arguments of an experiment."""
from pathlib import Path


def add_scene_files(parser):
    """An experiment's `add_arguments`."""
    parser.add_argument("--scenes", nargs="*", default=[], metavar="FILE",
                        help="scene files to measure besides the built-in scenes")


def scene_files(arguments):
    """Each configuration runs in a folder of its own: only whole paths lead anywhere."""
    return [str(Path(path).resolve()) for path in arguments.scenes]


def short_name(scene):
    """Of a file, its folder's name and its own; a built-in scene's name stays."""
    return "/".join(Path(scene).parts[-2:])
