"""One image of each kind of scene, of a size that fills a GPU: what experiments on execution
render, unless they ask for sizes."""
import shlex

from lib.scene_files import scene_files, short_name

IMAGES = {
    "spheres": "--scene spheres --width 1200 --height 600 --spp 50 --max-depth 50",
    "statue:1M": "--scene statue:1M --width 1024 --height 1024 --spp 16 --max-depth 8",
    "dial:16:0:closed": "--scene dial:16:0:closed --width 512 --height 512 --spp 16 --max-depth 8",
}
FILES = "--width 1024 --height 1024 --spp 16 --max-depth 8"  # of what --scenes names
QUICK = {
    "spheres": "--scene spheres --width 24 --height 12 --spp 2 --max-depth 50",
    "statue:1K": "--scene statue:1K --width 16 --height 16 --spp 2 --max-depth 8",
}


def images_of(arguments):
    """{scene: ptexp's options}"""
    if arguments.quick:
        return QUICK
    return {**IMAGES, **{short_name(path): f"--scene {shlex.quote(path)} {FILES}"
                         for path in scene_files(arguments)}}
