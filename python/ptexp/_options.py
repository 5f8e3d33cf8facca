"""From keywords to the words of the command line, by the program's own table of options."""
import difflib
import inspect
import os
import re
from typing import Any, Callable, Dict, List, Optional, Tuple

from . import _ptexp
from ._errors import OptionError, checked_text

TABLE = {option["keyword"]: option for option in _ptexp.options()}

# What the values of a tuple are joined by, where it is no comma.
_SEPARATORS = {"WxH": "x", "I/N": "/", "KIND[:A[:B]]": ":"}

_LOADING = {key for key, option in TABLE.items() if option["group"] == "Scene"}
OF_ONE_RENDER = {key for key, option in TABLE.items() if option["is_of_one_render"]}
# What ptexp.measure decides, or has no use for
OF_MEASURE = OF_ONE_RENDER | {"mode", "quiet"}


def keywords_of(function: str) -> List[str]:
    """The options that "load", "render" of a Scene, or "measure" can be given, in the table's order."""
    left_out = {"scene", "explain", *{"load": (), "render": _LOADING, "measure": OF_MEASURE}[function]}
    return [keyword for keyword in TABLE if keyword not in left_out]


def words_of_choice(option: Dict[str, str]) -> Optional[List[str]]:
    """The words that the option chooses from; None: it takes something else."""
    words = option["placeholder"].split("|")
    return words if option["form"] == "text" and all(re.fullmatch("[a-z][a-z0-9-]*", word) for word in words) else None


def takes_one_value(keyword: str) -> bool:
    """Whether the option is one number, one word or a truth, never a tuple."""
    option = _find(keyword)
    return option["form"] in ("number", "flag") or words_of_choice(option) is not None


def show_keywords(function: Callable, kind: str) -> None:
    """Gives a function that ends in ``**options`` the signature by which IPython completes them."""
    plain = inspect.signature(function)
    own = [parameter for parameter in plain.parameters.values() if parameter.kind != parameter.VAR_KEYWORD]
    names = {parameter.name for parameter in own}
    own += [inspect.Parameter(keyword, inspect.Parameter.KEYWORD_ONLY, default=None)
            for keyword in keywords_of(kind) if keyword not in names]
    function.__signature__ = plain.replace(parameters=own)  # type: ignore[attr-defined]


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


def split_loading(options: Dict[str, Any]) -> Tuple[Dict[str, Any], Dict[str, Any]]:
    """Those that only ptexp.load can be given, and the others."""
    loading = {keyword: value for keyword, value in options.items() if keyword in _LOADING}
    return loading, {keyword: value for keyword, value in options.items() if keyword not in loading}


def check_of_measure(options: Dict[str, Any]) -> None:
    """Raises OptionError for what a measurement decides itself, or has no use for."""
    for keyword in options:
        _find(keyword)
        if keyword in OF_MEASURE:
            raise OptionError(f"--{TABLE[keyword]['name']}: is no option of a measurement, which repeats renders of "
                              "`modes` and writes no files")


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
