"""Scenes out of dictionaries, in the form of Mitsuba 3's ``load_dict``."""
import os
from typing import Any, List, Tuple

from . import _ptexp
from ._arrays import floats, indices
from ._errors import Error

# (tag, attributes, children, place), as src/python/from_dict.cpp takes it
Element = Tuple[str, List[Tuple[str, str]], list, str]

_TAGS = {
    "integrator": "path volpath direct aov depth ptracer",
    "sensor": "perspective thinlens orthographic",
    "film": "hdrfilm ldrfilm specfilm",
    "sampler": "independent stratified multijitter orthogonal ldsampler",
    "rfilter": "box tent gaussian mitchell catmullrom lanczos",
    "texture": "bitmap checkerboard mesh_attribute scale",
    "emitter": "area point spot directional constant envmap sunsky sun sky projector",
    "shape": "obj ply serialized mesh sphere cube rectangle disk cylinder shapegroup instance merge",
    "bsdf": " ".join(_ptexp.surface_types()),
}
_TAG_OF = {kind: tag for tag, kinds in _TAGS.items() for kind in kinds.split()}
_COLORS = ("rgb", "srgb", "spectrum", "blackbody")


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if hasattr(value, "item"):
        value = value.item()
    return value if isinstance(value, str) else repr(value)


def _numbers(value: Any) -> List[float]:
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [x for part in value for x in _numbers(part)]
    return [float(value)]


class Converter:
    """Collects the meshes on its way through the dictionaries."""

    def __init__(self) -> None:
        self.meshes: list = []

    def object(self, name: str, given: dict, place: str, is_top: bool) -> Element:
        kind = given.get("type")
        if kind == "ref":
            return ("ref", [("name", name), ("id", str(given.get("id", "")))], [], place)
        if kind in _COLORS:
            return self.color(name, given, place)
        tag = "scene" if kind == "scene" else _TAG_OF.get(kind)
        if tag is None:
            raise Error(f"{place}: type {kind!r} is not known; expected one of {', '.join(sorted(_TAG_OF))}")
        attributes = [("type", kind)] if tag != "scene" else [("version", "3.0.0")]
        identity = given.get("id", name if is_top else None)
        if identity is not None and tag != "scene":
            attributes.append(("id", str(identity)))
        if not is_top:
            attributes.append(("name", name))
        given = {key: value for key, value in given.items() if key not in ("type", "id")}
        if kind == "mesh":
            given = self.mesh(given, place)
        children = [self.child(key, value, f"{place}[{key!r}]", tag == "scene") for key, value in given.items()]
        return (tag, attributes, children, place)

    def color(self, name: str, given: dict, place: str) -> Element:
        attributes = [("name", name)]
        for key, value in given.items():
            if key != "type":
                text = _text(value) if isinstance(value, (str, int, float)) else ", ".join(map(repr, _numbers(value)))
                attributes.append((key, text))
        return (given["type"], attributes, [], place)

    def mesh(self, given: dict, place: str) -> dict:
        parts = dict(given)
        vertices, triangles = parts.pop("vertices", None), parts.pop("triangles", parts.pop("faces", None))
        if vertices is None or triangles is None:
            raise Error(f"{place}: a mesh needs vertices (n, 3) and triangles (m, 3)")
        normals, uvs = parts.pop("normals", None), parts.pop("uvs", None)
        self.meshes.append((place, floats(vertices), indices(triangles),
                            None if normals is None else floats(normals), None if uvs is None else floats(uvs)))
        return {"data": place, **parts}

    def child(self, name: str, value: Any, place: str, is_top: bool) -> Element:
        if isinstance(value, dict):
            return self.object(name, value, place, is_top)
        if isinstance(value, (str, os.PathLike)):
            return ("string", [("name", name), ("value", os.fspath(value))], [], place)
        if isinstance(value, bool):
            return ("boolean", [("name", name), ("value", _text(value))], [], place)
        numbers = _numbers(value.matrix if hasattr(value, "matrix") else value)
        text = ", ".join(map(repr, numbers))
        if len(numbers) == 1:
            kind = "integer" if isinstance(value, int) else "float"
            return (kind, [("name", name), ("value", _text(value))], [], place)
        if len(numbers) == 3:
            return ("rgb", [("name", name), ("value", text)], [], place)
        if len(numbers) in (12, 16):
            text += ", 0, 0, 0, 1" if len(numbers) == 12 else ""
            matrix = ("matrix", [("value", text)], [], place)
            return ("transform", [("name", name)], [matrix], place)
        raise Error(f"{place}: {len(numbers)} numbers; expected one, three, or a matrix of 4x4")


def to_elements(scene: dict) -> Tuple[Element, list]:
    """The scene's element, and its meshes."""
    if not isinstance(scene, dict) or scene.get("type") != "scene":
        raise Error("a scene is a dictionary whose 'type' is 'scene'")
    converter = Converter()
    return converter.object("scene", scene, "scene", True), converter.meshes
