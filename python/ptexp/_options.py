"""From keywords to the words of the command line, by the program's own table of options."""
import difflib
import os
from typing import Any, Dict, List, Tuple

from . import _ptexp
from ._errors import OptionError, checked_text

TABLE = {option["keyword"]: option for option in _ptexp.options()}

# What the values of a tuple are joined by, where it is no comma.
_SEPARATORS = {"WxH": "x", "I/N": "/", "KIND[:A[:B]]": ":"}

_LOADING = {key for key, option in TABLE.items() if option["group"] == "Scene"}


def _find(keyword: str) -> dict:
    if keyword in TABLE:
        return TABLE[keyword]
    near = difflib.get_close_matches(keyword, TABLE, 1)
    hint = f"; did you mean {near[0]!r}?" if near else "; see ptexp.options()"
    raise OptionError(f"no option is called {keyword!r}{hint}")


def _number(value: Any) -> str:
    """Text of the same value: of numpy's numbers, too."""
    if hasattr(value, "item"):  # a scalar of numpy, an array of one
        value = value.item()
    if isinstance(value, bool):
        return "on" if value else "off"
    return value if isinstance(value, str) else repr(value)


def _words(option: dict, value: Any) -> List[str]:
    """Each value that the command line would be given for the option; none: it is not given."""
    if option["form"] == "flag":
        if not isinstance(value, bool):
            raise OptionError(f"--{option['name']} {value!r}: expected True or False")
        return ["on"] if value else []
    if option["form"] == "list":
        if not hasattr(value, "items"):
            raise OptionError(f"--{option['name']} {value!r}: expected a dictionary")
        return [f"{k}={_number(v)}" for k, v in value.items()]
    if isinstance(value, os.PathLike):
        return [os.fspath(value)]
    if isinstance(value, dict):
        return [",".join(f"{k}={_number(v)}" for k, v in value.items())]
    if isinstance(value, (str, int, float)) or getattr(value, "ndim", 1) == 0:
        return [_number(value)]
    try:
        parts = [os.fspath(v) if isinstance(v, os.PathLike) else _number(v) for v in value]
    except TypeError:
        raise OptionError(f"--{option['name']} {value!r}: expected a number, a text or a tuple") from None
    return [_SEPARATORS.get(option["placeholder"], ",").join(parts)]


def to_words(options: Dict[str, Any]) -> List[Tuple[str, str]]:
    """(keyword, text) of each option that is given; None stands for one that is not."""
    words = []
    for keyword, value in options.items():
        option = _find(keyword)
        if value is not None:
            words += [(keyword, checked_text(word)) for word in _words(option, value)]
    return words


def check_of_render(options: Dict[str, Any]) -> None:
    """Raises OptionError for what only ptexp.load can be given."""
    for keyword in options:
        if keyword in _LOADING:
            raise OptionError(f"--{TABLE[keyword]['name']}: belongs to ptexp.load, which reads the scene")


def as_documentation() -> str:
    """All options with their help, for docstrings."""
    lines, group = [], None
    for option in TABLE.values():
        if option["group"] != group:
            group = option["group"]
            lines.append(f"\n{group}:")
        standard = f", default {option['default']}" if option["default"] not in ("", "off") else ""
        kind = "bool" if option["form"] == "flag" else option["placeholder"]
        lines.append(f"    {option['keyword']} ({kind}{standard}):")
        lines += [f"        {line}" for line in option["help"].split("\n")]
    return "\n".join(lines)
