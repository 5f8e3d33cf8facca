#!/usr/bin/env python3
"""Renders as ptexp does, by the Python module, a scene that a Python file makes in memory.

    python_scene.py --scene FILE.py [OPTIONS]     options of a render, by their long names
    python_scene.py --version

FILE.py is run. It leaves a ptexp.Scene in its variable `scene`, as it was loaded, put together or
changed.
"""
import runpy
import sys
from pathlib import Path


def options_of(words, table):
    """{keyword: value} of options as the command line has them; `table`: ptexp.options()."""
    known = {f"--{option['name']}": option for option in table}
    options, words = {}, iter(words)
    for word in words:
        name, is_joined, value = word.partition("=")
        if name not in known:
            raise ValueError(f"{word}: no such option")
        option = known[name]
        if option["form"] != "flag" and not is_joined:
            value = next(words, None)
            if value is None:
                raise ValueError(f"{name}: expected a value")
        options[option["keyword"]] = True if option["form"] == "flag" else value
    return options


def scene_of(path):
    if path is None or not Path(path).is_file():
        raise ValueError(f"--scene {path}: expected a Python file")
    scene = runpy.run_path(path).get("scene")
    if not isinstance(scene, ptexp.Scene):
        raise ValueError(f"{path}: its variable `scene` is {type(scene).__name__}; expected a ptexp.Scene")
    return scene


def main(words):
    if words == ["--version"]:
        print("\n".join(f"{key} {value}" for key, value in ptexp.build_info().items()))
        return
    options = options_of(words, ptexp.options())
    scene = scene_of(options.pop("scene", None))
    ptexp.render(scene, **{"quiet": False, **options})


if __name__ == "__main__":
    try:
        import ptexp
        main(sys.argv[1:])
    except (ImportError, ValueError, OSError, RuntimeError) as error:  # ptexp.Error is a RuntimeError
        print(f"ptexp: error: {error}", file=sys.stderr)
        sys.exit(2)  # as ptexp's
