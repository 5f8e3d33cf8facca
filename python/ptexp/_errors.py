"""What goes wrong, as exceptions and warnings."""
import os
import re
import sys
import warnings
from pathlib import Path
from typing import Any, Optional, Tuple

__all__ = ["Error", "OptionError", "SceneWarning"]


class Error(RuntimeError):
    """Something that the user can mend: a file, a scene, a size, a device, too little memory."""

    # Without __init__: the module makes errors where no Python code may run (module.cpp).

    @property
    def file(self) -> Optional[str]:
        """The file that the message is about, also a missing one, or None."""
        return _place_of(str(self))[0]

    @property
    def line(self) -> Optional[int]:
        """The line there, from 1, or None."""
        return _place_of(str(self))[1]


_LINE = r"(?:(?:parse error at )?line (?P<line>\d+)\b)?"
_FILE_AND_LINE = re.compile(r"(?P<file>[^\n]+?):(?P<line>\d+)(?::\d+)?: ")  # and the column
_FAILED = re.compile(r"(?:^|: )cannot (?:read|write|open) (?P<file>[^\n]+?): " + _LINE)
_FILE = re.compile(r"(?P<file>[^\n]+?): " + _LINE)
_ENDINGS = re.compile(r"\.(xml|gltf|glb|obj|mtl|ply|pbrt|serialized|nvdb|vol|exr|png|ppm|hdr|pfm|jpe?g|json|csv)$|^<string>$", re.I)


def _place_of(message: str) -> Tuple[Optional[str], Optional[int]]:
    """The file and line that a message of the program names, in one of its three forms."""
    place = _FILE_AND_LINE.match(message) or _FAILED.search(message)
    if place is None and not message.startswith("--"):
        place = _FILE.match(message)
        if place and not (os.path.lexists(place["file"]) or _ENDINGS.search(place["file"])):
            place = None
    if place is None:
        return None, None
    return place["file"], int(place["line"]) if place["line"] else None


class OptionError(Error, ValueError):
    """An option that does not exist, has a wrong value, or has no effect together with the others.

    Messages name options as the command line does: ``--max-depth`` is the keyword ``max_depth``.
    """


class SceneWarning(UserWarning):
    """What a scene file asks for and ptexp does otherwise; and what a render could not do besides."""


def text_of_path(path: Any) -> str:
    """The name of a file as the program takes it."""
    text = os.fspath(path)
    text = os.fsdecode(text) if isinstance(text, bytes) else text
    return checked_text(text)


def checked_text(text: str) -> str:
    """The text, if the program can be given it as UTF-8 that a zero byte ends."""
    try:
        text.encode()
    except UnicodeEncodeError:
        raise Error(f"{ascii(text)}: expected text without lone surrogates, a name in UTF-8") from None
    if "\0" in text:
        raise Error(f"{ascii(text)}: expected text without zero bytes")
    return text


def warn(message: str) -> None:
    """A SceneWarning at the line that called the package."""
    folder = str(Path(__file__).parent)
    frame, level = sys._getframe(1), 2
    while frame and frame.f_code.co_filename.startswith(folder):
        frame, level = frame.f_back, level + 1
    warnings.warn(message, SceneWarning, stacklevel=level)
