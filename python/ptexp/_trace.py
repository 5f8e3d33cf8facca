"""Tracing rays alone, and comparing images."""
import os
from typing import Any, NamedTuple, Tuple, Union

from . import _ptexp
from ._arrays import floats, indices
from ._errors import text_of_path
from ._image import Image, _as_array


class Mesh:
    """Triangles with the tree that rays are traced through: built once, traced often.

    Args:
        vertices: (n, 3) float32.
        triangles: (m, 3) indices of vertices.
        device: "auto", "cpu", "cuda" or "cuda:N".
        accel: "auto" (cwbvh), "brute", "bvh2" or "cwbvh".
        builder: "auto", "sah", "sbvh"; on CUDA "lbvh", "hploc" and "hploc-reinsert", which build it
            for each call.

    Raises:
        OptionError: device, accel or builder.
        Error: vertices that are not finite, indices of no vertex, no triangles.
    """

    def __init__(self, vertices: Any, triangles: Any, *, device: str = "auto", accel: str = "auto", builder: str = "auto") -> None:
        self._native = _ptexp.TracedMesh(floats(vertices), indices(triangles), device, accel, builder)


class Hits(NamedTuple):
    """What rays hit, by ray."""

    t: Any  #: (k,) float32, in units of the direction's length; inf: nothing
    primitive: Any  #: (k,) uint32, the triangle; 0xffffffff: none
    uv: Any  #: (k, 2) float32, barycentric coordinates of the triangle's second and third vertex
    time_ms: float  #: of the tracing alone, kernel time on CUDA


def trace(mesh: Union[Mesh, Tuple[Any, Any]], rays: Any, *, any_hit: bool = False, **options: Any) -> Hits:
    """Finds the first triangle that each ray hits.

    Args:
        mesh: a :class:`Mesh`, or (vertices, triangles) to make one of.
        rays: (k, 6) float32: origin, direction; or (k, 8): origin, t_min, direction, t_max. Hits
            count for t_min < t < t_max. Directions need not have unit length.
        any_hit: only whether there is a hit: t is 0 or inf, primitive and uv say nothing.
        **options: of :class:`Mesh`, where one is made.

    Returns:
        Hits, whose arrays are numpy's where there is numpy.

    Raises:
        Error: rays that are not finite or have no direction; else as Mesh.
    """
    if not isinstance(mesh, Mesh):
        mesh = Mesh(*mesh, **options)
    elif options:
        raise TypeError("the options of a Mesh are given when it is made")
    t, primitive, uv, time_ms = mesh._native.trace(floats(rays), any_hit)
    return Hits(_as_array(t), _as_array(primitive), _as_array(uv), time_ms)


class Comparison(NamedTuple):
    """How far image a is from the reference b."""

    rmse: float  #: sqrt(mean (a - b)^2)
    relative_mse: float  #: mean of (a - b)^2 / (b^2 + 0.01)
    flip: float  #: FLIP, 0 to 1, how different they look
    largest: float  #: largest |a - b| of a value
    differing_pixels: int  #: in any bit
    pixels_past_tolerance: int  #: in any |a - b| > tolerance


def compare(a: Any, b: Any, *, tolerance: float = 0.0, hdr: Union[bool, None] = None) -> Comparison:
    """Compares two images of one size, as ``ptexp compare`` does.

    Args:
        a: an Image, an array (height, width, 3) of linear RGB, or a file.
        b: likewise: the reference.
        tolerance: for pixels_past_tolerance, 0 or more.
        hdr: whether FLIP is that of radiance, or of values for a display in [0, 1]; by default of
            radiance unless both are files of 8 bits.

    Raises:
        Error: the sizes differ, or a file cannot be read.
    """
    if not tolerance >= 0:
        raise ValueError(f"tolerance {tolerance}: expected 0 or more")
    if hdr is None:
        hdr = not all(_is_file(x) and not os.fspath(x).lower().endswith(".exr") for x in (a, b))
    return Comparison(**_ptexp.compare(_pixels(a), _pixels(b), tolerance, hdr))


def read_image(path: Union[str, "os.PathLike[str]"]) -> Image:
    """Reads an .exr, .png or .ppm into linear RGB; ``aovs`` has the layers of an .exr.

    Raises:
        Error: the file cannot be read.
    """
    return Image(_ptexp.read_image(text_of_path(path)))


def _is_file(image: Any) -> bool:
    return isinstance(image, (str, os.PathLike))


def _pixels(image: Any) -> Any:
    if _is_file(image):
        image = read_image(image)
    return image._native.pixels() if isinstance(image, Image) else floats(image)
