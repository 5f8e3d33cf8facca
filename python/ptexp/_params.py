"""Parameters of a scene that can be changed between renders."""
import difflib
from collections.abc import MutableMapping
from typing import Any, Iterator, List, NoReturn, Optional, Tuple

from . import _ptexp
from ._arrays import floats, numpy_for
from ._errors import Error

# Mitsuba's names of values, and ours: those that the BSDF or light has of these, which share the value.
_MITSUBA = {
    "reflectance": ("albedo",),
    "diffuse_reflectance": ("diffuse",),
    "specular_reflectance": ("specular", "tint", "reflected"),
    "specular_transmittance": ("passed",),
    "int_ior": ("eta",),
    "alpha": ("alpha_x", "alpha_y"),
    "alpha_u": ("alpha_x",),
    "alpha_v": ("alpha_y",),
    "irradiance": ("intensity",),
    "vertex_positions": ("vertices",),
    "vertex_normals": ("normals",),
}
_PARTS = ("camera", "materials", "lights", "instances", "meshes", "spheres")


def _flat(value: Any) -> List[float]:
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [x for part in value for x in _flat(part)]
    return [float(value)]


def _rows(matrix: List[float]) -> List[List[float]]:
    return [matrix[i : i + 4] for i in range(0, 16, 4)]


def _keys(name: str, value: Any, kind: str) -> Optional[List[Tuple[float, List[float]]]]:
    """Times and the numbers of matrices or points, if the value is a list of such pairs."""
    if not isinstance(value, (list, tuple)) or not any(isinstance(one, (list, tuple)) and len(one) == 2 for one in value):
        return None
    keys = []
    for i, pair in enumerate(value):
        try:
            time, place = pair
            keys.append((float(time), _flat(place)))
        except (TypeError, ValueError):
            raise Error(f"{name}: key {i}: expected a pair of a time in seconds and a {kind}") from None
    return keys


class Params(MutableMapping):
    """A scene's parameters by name: to read and, between renders, to change.

    ===============================  ===================================================
    ``camera.origin``, ``.target``   points, scene units, as the file says
    ``camera.up``                    a direction
    ``camera.to_world``              4x4 matrix: looks along z, x to the left, y up
    ``camera.shutter_open``          seconds; ``camera.shutter_close``: later
    ``camera.fov``                   degrees, in (0, 180); the axis is the scene's
    ``camera.aperture``              diameter of the lens, scene units; 0: a pinhole
    ``camera.focus_distance``        scene units, > 0
    ``materials.NAME.PARAMETER``     a number, or linear RGB; times its texture, if any
    ``lights.NAME.radiance``         of emitting surfaces: linear RGB, W / (m^2 sr)
    ``lights.NAME.intensity``        of points and spots: W / sr; of directions: W / m^2
    ``lights.sky.zenith``, ``nadir`` the background, W / (m^2 sr)
    ``instances.N.to_world``         4x4 matrix, affine, last row 0 0 0 1
    ``meshes.NAME.vertices``         (n, 3) array of numpy, as many as there are: points
                                     in the world, or in the space of its instances
    ``meshes.NAME.normals``          (n, 3), unit length, where the mesh has some; they
                                     do not follow the vertices
    ``spheres.NAME.center``          a point; ``spheres.NAME.radius``: > 0
    ===============================  ===================================================

    Values are numbers, tuples of three and 4x4 lists of lists; numpy's arrays are taken, too.
    Mitsuba's names are taken as well: ``materials.red.reflectance``, ``red.reflectance.value``,
    ``lamp.emitter.radiance.value``, ``bust.vertex_positions`` (flat or not), ``sensor.to_world``.

    A ``to_world`` or a sphere's ``center`` moves while the shutter is open if it is a list of pairs of
    a time in seconds and a matrix or point, [(t0, M0), (t1, M1)], times ascending; it reads as such a
    list. A single one, or for the camera an origin, target or up, stops it.

    A change costs what depends on it: of materials and lights their tables, of an instance the
    tree over instances, of vertices a refit of the mesh's tree (a new tree where that would be a
    third cheaper for rays), of a sphere, of what moves and of the shutter the whole preparation;
    the value that a parameter has already, nothing. An option of the camera (``look_from=``)
    overrides the parameter.

    Raises:
        KeyError: there is no such parameter. None can be added or deleted.
        Error: a value that the parameter cannot have; numpy is needed for a mesh and missing.
    """

    def __init__(self, native: "_ptexp.Scene") -> None:
        self._native = native
        self._entries = {name: (i, shape) for i, (name, shape) in enumerate(native.parameters())}

    def _find(self, name: str) -> Tuple[str, ...]:
        """The parameters that the name stands for: one, or several that have the same value."""
        if name in self._entries:
            return (name,)
        if isinstance(name, str):
            place, _, value = name.removesuffix(".value").rpartition(".")
            place = "camera" if place == "sensor" else place.removesuffix(".emitter")
            for part in ("", *(part + "." for part in _PARTS)):
                for ours in (value, *_MITSUBA.get(value, ())):
                    if f"{part}{place}.{ours}" not in self._entries:
                        continue
                    if value == "alpha" and ours != value:
                        return tuple(f"{part}{place}.{a}" for a in _MITSUBA[value])
                    return (f"{part}{place}.{ours}",)
        self._refuse(name)

    def _refuse(self, name: Any) -> NoReturn:
        near = difflib.get_close_matches(str(name), self._entries, 1)
        hint = f"; did you mean {near[0]!r}?" if near else "; print(scene.params) lists them"
        raise KeyError(f"no parameter is called {name!r}{hint}")

    def __getitem__(self, name: str) -> Any:
        names = self._find(name)
        index, shape = self._entries[names[0]]
        if names[0].startswith("meshes."):
            return numpy_for(names[0]).asarray(self._native.get_rows(index))
        values = self._native.get(index)
        if not shape:
            return values[0]
        show = tuple if len(shape) == 1 else _rows
        return [(time, show(place)) for time, place in self._native.get_keys(index)] or show(values)

    def __setitem__(self, name: str, value: Any) -> None:
        names = self._find(name)
        for own in names:
            index, shape = self._entries[own]
            if own.startswith("meshes."):
                numpy_for(own)
                rows = floats(value)
                self._native.set_rows(index, rows.reshape(-1, 3) if rows.ndim == 1 and rows.size % 3 == 0 else rows)
                continue
            kind = "4x4 matrix" if shape == (4, 4) else "point" if own.startswith("spheres.") and shape else None
            keys = _keys(own, value, kind) if kind else None
            if keys is not None:
                self._native.set_keys(index, keys)
                continue
            values = _flat(value)
            if shape == (3,) and len(values) == 1:
                values *= 3  # grey
            self._native.set(index, values)

    def __delitem__(self, name: str) -> None:
        raise TypeError("parameters of a scene cannot be deleted")

    def __contains__(self, name: object) -> bool:
        try:
            return bool(self._find(name))  # type: ignore[arg-type]
        except KeyError:
            return False

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)

    def __repr__(self) -> str:
        def text(name: str, shape: Tuple[int, ...]) -> Any:
            return f"an array of {shape[0]} x 3" if name.startswith("meshes.") else self[name]

        return "\n".join(f"{name} = {text(name, shape)}" for name, (_, shape) in self._entries.items())

    def _ipython_key_completions_(self) -> List[str]:
        return list(self._entries)
