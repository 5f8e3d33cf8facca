"""Writes ``_keywords.pyi``, the types of keywords, from the program's table of options.

The build calls ``python -m ptexp._stub FILE`` with the module that it has made. Type checkers alone
read the file, which is why it is no module.
"""
import re
import sys
from pathlib import Path
from typing import Any, Dict, List

from ._options import TABLE, keywords_of, words_of_choice

_HEAD = '''"""Types of keywords; made from the program's table of options."""
import os
from typing import Any, Iterable, Literal, Mapping, Optional, Sequence, TypedDict, Union

Path = Union[str, "os.PathLike[str]"]
Values = Union[str, "os.PathLike[str]", Iterable[Union[str, float, "os.PathLike[str]"]], Mapping[str, float]]
'''


def type_of(option: Dict[str, Any]) -> str:
    """Of the values that the keyword takes besides None."""
    form, words = option["form"], words_of_choice(option)
    if words is not None:
        literal = f"Literal[{', '.join(map(repr, words))}]"
        return f"Union[bool, {literal}]" if {"on", "off"} <= set(words) else literal
    if form == "number":
        names = option["placeholder"].split("|")
        number = "int" if "N" in names else "float"
        return number if len(names) == 1 else f"Union[{number}, str]"  # "auto", "64K"
    if form == "text" and re.search(r"FILE$", option["placeholder"]):
        return "Path"
    return {"flag": "bool", "list": "Mapping[str, Any]", "vector": "Union[str, Iterable[float]]"}.get(form, "Values")


def _dictionary(name: str, keywords: List[str], is_swept: bool = False) -> str:
    lines = [f"class {name}(TypedDict, total=False):"]
    for keyword in keywords:
        option = TABLE[keyword]
        kind = type_of(option)
        if is_swept and option["group"] != "Scene":
            kind = f"Union[{kind}, Sequence[{kind}]]"
        lines.append(f"    {keyword}: Optional[{kind}]")
    return "\n".join(lines)


def stub() -> str:
    """The text of the file."""
    return "\n\n".join([
        _HEAD + f"Mode = {type_of(TABLE['mode'])}",
        _dictionary("RenderOptions", keywords_of("render")),
        _dictionary("LoadOptions", keywords_of("load")),
        _dictionary("MeasureOptions", keywords_of("measure")),
        _dictionary("SweepOptions", keywords_of("measure"), is_swept=True)]) + "\n"


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(stub(), encoding="utf-8")
