"""Scenes out of dictionaries, in the form of Mitsuba 3's ``load_dict``."""
import difflib
import os
from typing import Any, Dict, List, Optional, Tuple

from . import _ptexp
from ._arrays import floats, indices, linear_of_srgb, numpy_for
from ._errors import Error, checked_text

# (tag, attributes, children, place), as src/python/from_dict.cpp takes it
Element = Tuple[str, List[Tuple[str, str]], list, str]

_TAG_OF = {kind: tag for tag, kinds in _ptexp.plugin_types() for kind in kinds}
_COLORS = ("rgb", "srgb", "spectrum")  # attributes of one element, not plugins
_LISTS = ("values", "wavelengths", "range")  # of spectra, of any length
MOST_DEPTH = 64


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return value if isinstance(value, str) else repr(value)


def _has(value: Any, name: str) -> bool:
    """By its type or its own attributes: drjit's arrays answer to every name, ``matrix`` as well."""
    return hasattr(type(value), name) or name in getattr(value, "__dict__", ())


def _plain(value: Any) -> Any:
    """A number of Python, of numpy's numbers and arrays without dimensions."""
    return value.item() if _has(value, "item") and getattr(value, "ndim", 1) == 0 else value


def _items(value: Any) -> Optional[list]:
    """What a list or an array of numpy, drjit or another package has in it; None: it is none."""
    if isinstance(value, (list, tuple)):
        return list(value)
    if _has(value, "tolist"):
        return value.tolist()
    if _has(value, "__array__"):
        try:
            import numpy
            return numpy.asarray(value).tolist()
        except ImportError:
            pass
    try:
        return memoryview(value).tolist()
    except TypeError:
        return list(value) if _has(value, "__len__") and _has(value, "__iter__") else None


def _numbers(value: Any, place: str) -> List[float]:
    """All numbers of nested lists and arrays, the last index fastest."""
    value = _plain(value)
    items = None if isinstance(value, (str, bytes, dict)) else _items(value)
    if items is not None:
        return [x for part in items for x in _numbers(part, place)]
    try:
        return [float(value)]
    except (TypeError, ValueError):
        raise Error(f"{place}: {type(value).__name__} {value!r:.80}; expected a number, text, a list or array of "
                    "numbers, a transform or a dictionary") from None


def _matrix(numbers: List[float], is_of_plane: bool) -> Optional[List[float]]:
    """The 4x4 numbers of a transform that is given as 4x4, 3x4 or 3x3, where `is_of_plane` means (u, v, 1)."""
    if len(numbers) == 9 and is_of_plane:
        a, b, u, c, d, v = numbers[:6]
        return [a, b, 0, u, c, d, 0, v, 0, 0, 1, 0, 0, 0, 0, 1]
    if len(numbers) == 12:
        return [*numbers, 0, 0, 0, 1]
    return numbers if len(numbers) in (9, 16) else None


def _joined(numbers: List[float]) -> str:
    return ", ".join(map(repr, numbers))


def _picture(value: Any, place: str, is_raw: bool, as_floats: bool) -> Any:
    """(height, width, 3): linear float32, or the bytes of an 8-bit image where these will do.

    ``value``: an array (height, width) or (height, width, 1 to 4) of linear floats or of integers in
    the sRGB curve; a ``mitsuba.Bitmap``, which knows its curve. Alpha is left out, as in Mitsuba.
    """
    numpy = numpy_for(place)
    array = numpy.asarray(value)
    array = array[..., None] if array.ndim == 2 else array
    if array.ndim != 3 or not 1 <= array.shape[2] <= 4 or 0 in array.shape or array.dtype.kind not in "fu":
        raise Error(f"{place}: an array {array.shape} of {array.dtype}; expected (height, width, 1 to 4) of floats "
                    "or unsigned integers")
    array = array[..., :3] if array.shape[2] > 2 else numpy.repeat(array[..., :1], 3, axis=2)
    is_encoded = value.srgb_gamma() if _has(value, "srgb_gamma") else array.dtype.kind == "u"
    if array.dtype == numpy.uint8 and not as_floats and (is_encoded or is_raw):
        return numpy.ascontiguousarray(array)
    if array.dtype.kind == "u":
        array = array / numpy.iinfo(array.dtype).max
    if not numpy.isfinite(array).all():
        raise Error(f"{place}: a value that is not finite")
    if is_encoded and not is_raw:
        array = linear_of_srgb(array)
    return numpy.ascontiguousarray(array, numpy.float32)


def _grid(value: Any, place: str) -> Any:
    """(z, y, x, channels) float32 of an array (z, y, x), one (z, y, x, 1 or 3), or a ``mitsuba.VolumeGrid``."""
    numpy = numpy_for(place)
    array = numpy.ascontiguousarray(value, numpy.float32)
    array = array[..., None] if array.ndim == 3 else array
    if array.ndim != 4 or array.shape[3] not in (1, 3) or 0 in array.shape:
        raise Error(f"{place}: an array {array.shape}; expected (z, y, x) or (z, y, x, 1 or 3)")
    if not (numpy.isfinite(array).all() and (array >= 0).all()):
        raise Error(f"{place}: a value that is not finite or below 0")
    return array


class Converter:
    """Collects the arrays on its way through the dictionaries, each with its place in them."""

    def __init__(self) -> None:
        self.meshes: list = []
        self.pictures: list = []
        self.grids: list = []

    def object(self, name: str, given: Dict[str, Any], place: str, is_top: bool) -> Element:
        kind = given.get("type")
        if kind == "ref":
            return ("ref", [("name", name), ("id", str(given.get("id", "")))], [], place)
        if kind == "resources":
            return ("path", [("value", os.fspath(given.get("path", "")))], [], place)
        if kind in _COLORS and "color" not in given:
            return self.color(name, given, place)
        tag = self.tag(kind, place)
        if place.count("[") > MOST_DEPTH:
            raise Error(f"scene: dictionaries are nested deeper than {MOST_DEPTH}")
        attributes = [("type", str(kind))] if tag != "scene" else [("version", "3.0.0")]
        identity = given.get("id", name if is_top else None)
        if identity is not None and tag != "scene":
            attributes.append(("id", str(identity)))
        if not is_top:
            attributes.append(("name", name))
        given = {key: value for key, value in given.items() if key not in ("type", "id")}
        given = self.without_arrays(str(kind), given, place)
        children = [self.child(key, value, f"{place}[{key!r}]", tag == "scene") for key, value in given.items()]
        return (tag, attributes, children, place)

    def tag(self, kind: Any, place: str) -> str:
        if kind == "scene":
            return "scene"
        if kind in _TAG_OF:
            return _TAG_OF[kind]
        if kind is None:
            raise Error(f"{place}: a dictionary without 'type'")
        near = difflib.get_close_matches(str(kind), _TAG_OF, 1)
        hint = f"did you mean {near[0]!r}?" if near else f"expected one of {', '.join(sorted(_TAG_OF))}"
        raise Error(f"{place}: type {kind!r} is not known; {hint}")

    def color(self, name: str, given: Dict[str, Any], place: str) -> Element:
        attributes = [("name", name)]
        for key, value in given.items():
            if key in ("type", "id"):
                continue
            value = _plain(value)
            if isinstance(value, (str, os.PathLike, int, float)):
                text = _text(os.fspath(value) if isinstance(value, os.PathLike) else value)
            else:
                numbers = _numbers(value, f"{place}[{key!r}]")
                text = _joined(numbers)
                if given["type"] == "spectrum" and len(numbers) != 3 and len(numbers) % 2 == 0:  # (wavelength, value)
                    text = ", ".join(f"{a!r}:{b!r}" for a, b in zip(numbers[::2], numbers[1::2]))
            attributes.append((key, text))
        return (given["type"], attributes, [], place)

    def without_arrays(self, kind: str, given: Dict[str, Any], place: str) -> Dict[str, Any]:
        """The properties with the name of an array in its place."""
        if kind == "mesh":
            return self.mesh(given, place)
        names = {"bitmap": ("bitmap", "data"), "envmap": ("bitmap", "data"), "gridvolume": ("grid", "data")}
        name = next((one for one in names.get(kind, ()) if one in given), None)
        if name is None:
            return given
        given = dict(given)
        value, where = given.pop(name), f"{place}[{name!r}]"
        if kind == "gridvolume":
            self.grids.append((where, _grid(value, where)))
        else:
            is_raw = bool(_plain(given.get("raw", False)))
            self.pictures.append((where, _picture(value, where, is_raw, kind == "envmap")))
        return {**given, "data": where}

    def mesh(self, given: Dict[str, Any], place: str) -> Dict[str, Any]:
        parts = dict(given)
        vertices, triangles = parts.pop("vertices", None), parts.pop("triangles", parts.pop("faces", None))
        if vertices is None or triangles is None:
            raise Error(f"{place}: a mesh needs vertices (n, 3) and triangles (m, 3)")
        normals, uvs = parts.pop("normals", None), parts.pop("uvs", None)
        try:
            self.meshes.append((place, floats(vertices), indices(triangles),
                                None if normals is None else floats(normals), None if uvs is None else floats(uvs)))
        except ValueError as error:
            raise ValueError(f"{place}: {error}") from None
        return {"data": place, **parts}

    def child(self, name: str, value: Any, place: str, is_top: bool) -> Element:
        if not isinstance(name, str):
            raise Error(f"{place}: the key is no text")
        value = _plain(value)
        if isinstance(value, dict) and value.get("type") == "lookat":
            return self.look_at(name, value, place)
        if isinstance(value, dict):
            return self.object(name, value, place, is_top)
        if isinstance(value, (str, os.PathLike)):
            return ("string", [("name", name), ("value", checked_text(os.fspath(value)))], [], place)
        if isinstance(value, (bool, int, float)):
            kind = {bool: "boolean", int: "integer"}.get(type(value), "float")
            return (kind, [("name", name), ("value", _text(value))], [], place)
        return self.array(name, value, place)

    def look_at(self, name: str, given: Dict[str, Any], place: str) -> Element:
        if set(given) - {"up"} != {"type", "origin", "target"}:
            raise Error(f"{place}: {', '.join(given)}; expected type, origin, target and perhaps up")
        vectors = [(key, _joined(_numbers(value, f"{place}[{key!r}]"))) for key, value in given.items() if key != "type"]
        return ("transform", [("name", name)], [("lookat", vectors, [], place)], place)

    def array(self, name: str, value: Any, place: str) -> Element:
        is_transform = _has(value, "matrix")
        numbers = _numbers(value.matrix if is_transform else value, place)
        if name in _LISTS:
            return ("string", [("name", name), ("value", _joined(numbers))], [], place)
        if len(numbers) == 1:
            return ("float", [("name", name), ("value", repr(numbers[0]))], [], place)
        if len(numbers) == 3:
            return ("rgb", [("name", name), ("value", _joined(numbers))], [], place)
        matrix = _matrix(numbers, is_transform or name == "to_uv")
        if matrix is None:
            raise Error(f"{place}: {len(numbers)} numbers; expected one, three, or a matrix of 3x3, 3x4 or 4x4")
        return ("transform", [("name", name)], [("matrix", [("value", _joined(matrix))], [], place)], place)


def to_elements(scene: Dict[str, Any]) -> Tuple[Element, Converter]:
    """The scene's element, and its arrays."""
    if not isinstance(scene, dict) or scene.get("type") != "scene":
        raise Error("a scene is a dictionary whose 'type' is 'scene'")
    converter = Converter()
    return converter.object("scene", scene, "scene", True), converter
