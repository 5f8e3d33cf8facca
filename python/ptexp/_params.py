"""Parameters of a scene that can be changed between renders."""
from collections.abc import MutableMapping
from typing import Any, Iterator, List

from . import _ptexp


def _flat(value: Any) -> List[float]:
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [x for part in value for x in _flat(part)]
    return [float(value)]


class Params(MutableMapping):
    """A scene's parameters by name: to read and, between renders, to change.

    ===============================  ===================================================
    ``camera.origin``, ``.target``   points, scene units
    ``camera.up``                    a direction
    ``camera.fov``                   degrees, in (0, 180); the axis is the scene's
    ``camera.aperture``              diameter of the lens, scene units; 0: a pinhole
    ``camera.focus_distance``        scene units, > 0
    ``materials.NAME.PARAMETER``     a number, or linear RGB; times its texture, if any
    ``lights.NAME.radiance``         of emitting surfaces: linear RGB, W / (m^2 sr)
    ``lights.NAME.intensity``        of points and spots: W / sr; of directions: W / m^2
    ``lights.sky.zenith``, ``nadir`` the background, W / (m^2 sr)
    ``instances.N.to_world``         4x4 matrix, affine, last row 0 0 0 1
    ===============================  ===================================================

    Values are numbers, tuples of three and 4x4 lists of lists; numpy's arrays are taken, too. A
    camera that is changed costs no new acceleration structure in scenes of triangles; anything else
    has the scene prepared again, but never read again. An option of the camera (``look_from=``)
    overrides the parameter.

    Raises:
        KeyError: there is no such parameter. None can be added or deleted.
        Error: a value that the parameter cannot have.
    """

    def __init__(self, native: "_ptexp.Scene") -> None:
        self._native = native
        self._entries = {name: (i, shape) for i, (name, shape) in enumerate(native.parameters())}

    def __getitem__(self, name: str) -> Any:
        index, shape = self._entries[name]
        values = self._native.get(index)
        if not shape:
            return values[0]
        if len(shape) == 1:
            return tuple(values)
        return [values[i : i + shape[1]] for i in range(0, len(values), shape[1])]

    def __setitem__(self, name: str, value: Any) -> None:
        index, shape = self._entries[name]
        values = _flat(value)
        if shape == (3,) and len(values) == 1:
            values *= 3  # grey
        self._native.set(index, values)

    def __delitem__(self, name: str) -> None:
        raise TypeError("parameters of a scene cannot be deleted")

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)

    def __repr__(self) -> str:
        return "\n".join(f"{name} = {self[name]}" for name in self)
