"""Arrays of whoever calls, as the module takes them."""
from typing import Any

from ._errors import Error

MOST_INDEX = 2**32 - 1


def numpy_for(what: str) -> Any:
    """The module numpy; an Error, which names its use, where it is not installed."""
    try:
        import numpy
    except ImportError:
        raise Error(f"{what}: needs numpy, which is not installed") from None
    return numpy


def linear_of_srgb(values: Any) -> Any:
    """The linear values of a numpy array in the sRGB curve (IEC 61966-2-1), 1 being white."""
    numpy = numpy_for("the sRGB curve")
    return numpy.where(values <= 0.04045, values / 12.92, ((numpy.maximum(values, 0) + 0.055) / 1.055) ** 2.4)


def floats(values: Any) -> Any:
    """float32, C order; a copy only where it is neither. Needs numpy for anything but arrays."""
    return _converted(values, "float32")


def indices(values: Any) -> Any:
    """uint32, likewise."""
    return _converted(values, "uint32")


def _converted(values: Any, kind: str) -> Any:
    try:
        import numpy
    except ImportError:
        return values
    if not isinstance(values, numpy.ndarray) and hasattr(values, "__dlpack__"):
        values = numpy.from_dlpack(values)
    array = numpy.asarray(values)
    if array.dtype.kind not in "biufO":
        raise ValueError(f"an array of {array.dtype}; expected numbers")
    if kind == "uint32":
        _check_indices(numpy, array)
    with numpy.errstate(over="ignore"):  # infinities are refused by whoever has no use for them
        return numpy.ascontiguousarray(array, dtype=kind)


def _check_indices(numpy: Any, array: Any) -> None:
    """A conversion makes another index of what is none: of 2^32 + 2 it makes 2, of NaN 0."""
    if array.dtype.kind == "O":  # integers of any size
        right = numpy.array([isinstance(x, int) and 0 <= x <= MOST_INDEX for x in array.flat], bool)
    else:
        with numpy.errstate(invalid="ignore"):
            right = ((array >= 0) & (array <= MOST_INDEX) & (array == numpy.floor(array))).ravel()
    if not right.all():
        wrong = array.flat[int(numpy.argmin(right))]
        raise ValueError(f"triangles: the index {wrong}; expected whole numbers from 0 to {MOST_INDEX}")
