"""Arrays of whoever calls, as the module takes them."""
from typing import Any


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
    if kind == "uint32" and array.size and array.min() < 0:
        raise ValueError("triangles: a negative index")
    return numpy.ascontiguousarray(array, dtype=kind)
