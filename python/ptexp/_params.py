"""Parameters of a scene that can be changed between renders."""
import difflib
from collections.abc import MutableMapping
from typing import Any, Iterator, List, NoReturn, Tuple

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
_VIEW = ("camera.origin", "camera.target", "camera.up")


def _flat(value: Any) -> List[float]:
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [x for part in value for x in _flat(part)]
    return [float(value)]


def _cross(a: Tuple[float, ...], b: Tuple[float, ...]) -> Tuple[float, ...]:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _unit(v: Tuple[float, ...]) -> Tuple[float, ...]:
    length = sum(x * x for x in v) ** 0.5
    return tuple(x / length for x in v)


class Params(MutableMapping):
    """A scene's parameters by name: to read and, between renders, to change.

    ===============================  ===================================================
    ``camera.origin``, ``.target``   points, scene units, as the file says
    ``camera.up``                    a direction
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
    ``lamp.emitter.radiance.value``, ``bust.vertex_positions`` (flat or not), ``sensor.to_world``
    (also ``camera.to_world``: 4x4, of origin, target and up).

    A change costs what depends on it: of materials and lights their tables, of an instance the
    tree over instances, of vertices a refit of the mesh's tree (a new tree where that would be a
    third cheaper for rays), of a sphere
    the whole preparation; the value that a parameter has already, nothing. An option of the
    camera (``look_from=``) overrides the parameter.

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
            if name in ("camera.to_world", "sensor.to_world"):
                return _VIEW
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
        if names == _VIEW:
            return self._view()
        index, shape = self._entries[names[0]]
        if names[0].startswith("meshes."):
            return numpy_for(names[0]).asarray(self._native.get_rows(index))
        values = self._native.get(index)
        if not shape:
            return values[0]
        if len(shape) == 1:
            return tuple(values)
        return [values[i : i + shape[1]] for i in range(0, len(values), shape[1])]

    def __setitem__(self, name: str, value: Any) -> None:
        names = self._find(name)
        if names == _VIEW:
            self._set_view(name, value)
            return
        for own in names:
            index, shape = self._entries[own]
            if own.startswith("meshes."):
                numpy_for(own)
                rows = floats(value)
                self._native.set_rows(index, rows.reshape(-1, 3) if rows.ndim == 1 and rows.size % 3 == 0 else rows)
                continue
            values = _flat(value)
            if shape == (3,) and len(values) == 1:
                values *= 3  # grey
            self._native.set(index, values)

    def _view(self) -> List[List[float]]:
        """As Mitsuba has it: the axes are left, up and forward."""
        origin, target, up = (self[name] for name in _VIEW)
        forward = _unit(tuple(b - a for a, b in zip(origin, target)))
        left = _unit(_cross(up, forward))
        return [*map(list, zip(left, _cross(forward, left), forward, origin)), [0.0, 0.0, 0.0, 1.0]]

    def _set_view(self, name: str, value: Any) -> None:
        m = _flat(value)
        if len(m) != 16 or m[12:] != [0, 0, 0, 1]:
            raise Error(f"{name}: expected a 4x4 matrix, its last row 0 0 0 1")
        left, up, forward, origin = (tuple(m[column:12:4]) for column in range(4))
        if not sum(x * y for x, y in zip(_cross(up, forward), left)) > 0:
            raise Error(f"{name}: expected a matrix that can be inverted and does not mirror")
        forward = _unit(forward)
        distance = max(1.0, *map(abs, origin))  # far enough that rounding does not turn the view
        for own, v in zip(_VIEW, (origin, tuple(o + distance * f for o, f in zip(origin, forward)), up)):
            self[own] = v

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
