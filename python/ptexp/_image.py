"""Images in memory."""
import json
import operator
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Callable, Dict, Iterator, Optional, Union

from . import _ptexp
from ._arrays import floats, linear_of_srgb, numpy_for
from ._errors import Error, text_of_path

Exposure = Union[str, float, None]


class Layers(Mapping):
    """AOVs by name: arrays (height, width, channels), or (height, width) of those with one channel.

    float32, linear; uint32 for ``primitive``, ``instance`` and ``material``. They are views of the
    image's memory.
    """

    def __init__(self, native: "_ptexp.Image") -> None:
        self._native = native

    def __getitem__(self, name: str) -> Any:
        return _as_array(self._native.layer(name))

    def __iter__(self) -> Iterator[str]:
        return iter(self._native.layer_names())

    def __len__(self) -> int:
        return len(self._native.layer_names())

    def __repr__(self) -> str:
        return f"<ptexp.Layers {list(self)}>"


def _as_array(native: Any) -> Any:
    """A numpy array where there is numpy, else something with DLPack and the buffer protocol."""
    try:
        import numpy
    except ImportError:
        return native
    return numpy.asarray(memoryview(native))


class Image:
    """A rendered image: (height, width, 3) float32, linear RGB radiance, the first row on top.

    ``numpy.asarray(image)``, ``torch.from_dlpack(image)``, ``cupy.from_dlpack``,
    ``jax.dlpack.from_dlpack`` take it without a copy. The memory is the host's, whatever device
    rendered it, unless ``on_device=True`` left it in that of a GPU: DLPack and CUDA's array
    interface then give the GPU's, which is complete and which no later render touches; numpy,
    ``array`` and ``save`` a copy of it in the host's, made once. Layers are always the host's.

    ``+ - * /`` with numbers, images and arrays give an image of new pixels without layers,
    statistics and header, which would be wrong; ``image[rows, columns]`` is a view as of numpy's
    arrays, to read and to write. Both need numpy. Images can be pickled and copied with all that
    they have; a GPU's becomes the host's. A notebook shows them as a PNG would be.
    """

    __array_priority__ = 1000  # array * image is an image, as image * array is

    def __init__(self, native: "_ptexp.Image") -> None:
        self._native = native
        self._stats: Optional[Dict[str, Any]] = None

    @property
    def width(self) -> int:
        """Pixels in a row."""
        return self._native.width

    @property
    def height(self) -> int:
        """Rows."""
        return self._native.height

    @property
    def shape(self) -> tuple:
        """(height, width, 3)"""
        return (self.height, self.width, 3)

    @property
    def array(self) -> Any:
        """A numpy array of the image's memory: (height, width, 3) float32, linear RGB.

        Without numpy an object with ``__dlpack__`` and the buffer protocol.
        """
        return _as_array(self._native.pixels())

    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> Any:
        import numpy

        array = self.array
        wanted = array.dtype if dtype is None else numpy.dtype(dtype)
        if wanted != array.dtype:
            if copy is False:
                raise ValueError("an image is float32: another type needs a copy")
            return array.astype(wanted)
        return array.copy() if copy else array

    def __dlpack__(self, **arguments: Any) -> Any:
        return self._native.device_pixels().__dlpack__(**arguments)

    def __dlpack_device__(self) -> tuple:
        return self._native.device_pixels().__dlpack_device__()

    @property
    def __cuda_array_interface__(self) -> Dict[str, Any]:
        pointer = self._native.device_pointer()
        if not pointer:
            raise AttributeError("the image is in the host's memory: on_device=True leaves it on the GPU")
        return {"shape": self.shape, "typestr": "<f4", "data": (pointer, False), "version": 3,
                "strides": None, "stream": None}

    @property
    def stats(self) -> Dict[str, Any]:
        """All that is known of the render: what ``ptexp --stats`` writes (docs/statistics.md).

        Empty for an image that was read from a file.
        """
        if self._stats is None:
            text = self._native.statistics()
            self._stats = json.loads(text) if text else {}
        return self._stats

    @property
    def metadata(self) -> Dict[str, str]:
        """What the image's file has, or will have, in its header."""
        return dict(self._native.header())

    @property
    def aovs(self) -> Layers:
        """The layers that ``aov=`` asked for: ``image.aovs["depth"]``."""
        return Layers(self._native)

    def __getitem__(self, index: Any) -> Any:
        return self.array[index]

    def __setitem__(self, index: Any, value: Any) -> None:
        self.array[index] = value

    def __len__(self) -> int:
        return self.height

    def _made(self, operation: Callable[[Any, Any], Any], a: Any, b: Any) -> "Image":
        numpy = numpy_for("arithmetic of images")
        values = [numpy.asarray(x) for x in (a, b)]
        if any(x.dtype.kind not in "biuf" for x in values):
            return NotImplemented
        with numpy.errstate(all="ignore"):  # of x / 0, as of the program's own images
            result = operation(*(x.astype(numpy.float32, copy=False) for x in values))
        if result.shape != self.shape:
            raise ValueError(f"an image {self.shape} and an array give {result.shape}; expected {self.shape}")
        return image_of(result, exposure=self._native.exposure())

    def __add__(self, other: Any) -> "Image":
        return self._made(operator.add, self, other)

    def __radd__(self, other: Any) -> "Image":
        return self._made(operator.add, other, self)

    def __sub__(self, other: Any) -> "Image":
        return self._made(operator.sub, self, other)

    def __rsub__(self, other: Any) -> "Image":
        return self._made(operator.sub, other, self)

    def __mul__(self, other: Any) -> "Image":
        return self._made(operator.mul, self, other)

    def __rmul__(self, other: Any) -> "Image":
        return self._made(operator.mul, other, self)

    def __truediv__(self, other: Any) -> "Image":
        return self._made(operator.truediv, self, other)

    def __rtruediv__(self, other: Any) -> "Image":
        return self._made(operator.truediv, other, self)

    def __neg__(self) -> "Image":
        return self._made(operator.mul, self, -1.0)

    def __reduce__(self) -> tuple:
        return _restored, (self._native.state(), self.stats)

    def to_srgb(self, *, exposure: Exposure = None) -> Any:
        """What a .png shows: a numpy array (height, width, 3) uint8 in the sRGB curve.

        Args:
            exposure: as for :meth:`save`.
        """
        numpy = numpy_for("to_srgb")
        bytes_of_pixels = self._native.srgb(_exposure_word(exposure))
        return numpy.frombuffer(bytearray(bytes_of_pixels), numpy.uint8).reshape(self.shape)

    def _repr_png_(self) -> bytes:
        return self._native.png("")

    def show(self, *, exposure: Exposure = None) -> Optional[Path]:
        """Shows the image: in a notebook below the cell, else in the system's viewer.

        Args:
            exposure: as for :meth:`save`.

        Returns:
            In a notebook None; else a temporary .png, which the viewer was given. Without a display
            that is all, and no error.
        """
        png = self._native.png(_exposure_word(exposure))
        if _is_notebook():
            from IPython.display import Image as Shown, display

            display(Shown(data=png, format="png"))
            return None
        with tempfile.NamedTemporaryFile(prefix="ptexp-", suffix=".png", delete=False) as file:
            file.write(png)
        _open_in_viewer(file.name)
        return Path(file.name)

    def save(self, path: Union[str, "os.PathLike[str]"], *, exposure: Exposure = None) -> None:
        """Writes an .exr (linear float, with layers), .png (sRGB) or .ppm, as the program does.

        Args:
            path: the file; its ending is the format.
            exposure: stops for a .png or .ppm, or "auto"; by default as the render was asked.

        Raises:
            Error: the file cannot be written.
            OptionError: ``exposure`` is neither.
        """
        self._native.save(text_of_path(path), _exposure_word(exposure))

    def __repr__(self) -> str:
        return f"<ptexp.Image {self.width}x{self.height}>"


def _exposure_word(exposure: Exposure) -> str:
    return "" if exposure is None else str(exposure)


def _restored(state: tuple, stats: Dict[str, Any]) -> Image:
    image = Image(_ptexp.image_of_state(state))
    image._stats = stats
    return image


def image_of(pixels: Any, layers: Optional[Mapping] = None, header: Optional[Mapping] = None, exposure: str = "") -> Image:
    """An image of arrays (see :func:`write_image`), which are copied."""
    numpy = numpy_for("an image of arrays")
    array = numpy.asarray(pixels)
    if array.dtype == numpy.uint8:  # as to_srgb() gives them
        array = linear_of_srgb(array / numpy.float32(255))
    array = numpy.repeat(array[..., None], 3, axis=2) if array.ndim == 2 else array
    if array.ndim != 3 or array.shape[2] != 3 or 0 in array.shape:
        raise ValueError(f"an array {array.shape}; expected (height, width, 3) or (height, width)")
    height, width = array.shape[:2]
    states = []
    for name, values in (layers or {}).items():
        values = numpy.asarray(values)
        depth = values.shape[2] if values.ndim == 3 else 1
        if values.shape[:2] != (height, width) or values.ndim > 3 or not 1 <= depth <= 4:
            raise ValueError(f"aovs[{name!r}]: an array {values.shape}; expected ({height}, {width}) or "
                             f"({height}, {width}, 1 to 4)")
        is_number = values.dtype.kind in "bui"
        values = numpy.ascontiguousarray(values, numpy.uint32 if is_number else numpy.float32)
        states.append((name, ("V", "UV", "RGB", "RGBA")[depth - 1], is_number, values.tobytes()))
    return _restored((width, height, floats(array).tobytes(), states, dict(header or {}), exposure), {})


def write_image(path: Union[str, "os.PathLike[str]"], image: Any, *, aovs: Optional[Mapping] = None,
                metadata: Optional[Mapping] = None, exposure: Exposure = None) -> None:
    """Writes an array as an .exr (linear float), .png (sRGB) or .ppm.

    Args:
        path: the file; its ending is the format.
        image: (height, width, 3) or (height, width): linear RGB or grey, any floats or integers;
            uint8 are sRGB values of a display, 0 to 255. Or an :class:`Image`, with its header.
        aovs: further layers of an .exr by name: (height, width) or (height, width, 1 to 4); whole
            numbers as uint32, else float32. By default those of an Image.
        metadata: texts by name for the header of an .exr or .png.
        exposure: stops for a .png or .ppm, or "auto"; by default 0, an Image's own.

    Raises:
        ValueError: the array has another shape.
        Error: the file cannot be written.
        OptionError: ``exposure`` is neither.
    """
    if isinstance(image, Image):
        if aovs or metadata:
            image = image_of(image, image.aovs if aovs is None else aovs, {**image.metadata, **(metadata or {})},
                             image._native.exposure())
    else:
        image = image_of(image, aovs, metadata)
    image.save(path, exposure=exposure)


def denoise(image: Image) -> Image:
    """Removes noise by Intel's Open Image Denoise, on the CPU; needs ``pip install ptexp[denoise]``.

    Args:
        image: rendered with ``aov=("albedo", "normal")``, which it then uses, or without.

    Returns:
        A new image of the same size, without layers, statistics and header.

    Raises:
        Error: the package ``pyoidn`` is not installed, or fails.
    """
    try:
        import pyoidn  # type: ignore
    except ImportError:
        raise Error("denoise: needs the package pyoidn: pip install ptexp[denoise]") from None
    guides = {name: image.aovs[name] for name in ("albedo", "normal") if name in image.aovs}
    if "albedo" not in guides:  # the library takes a normal only beside one
        guides.clear()
    try:
        pixels = pyoidn.denoise(image.array, hdr=True, **guides)
    except RuntimeError as error:
        raise Error(f"denoise: {error}") from error
    return image_of(pixels, exposure=image._native.exposure())


def _is_notebook() -> bool:
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return hasattr(shell, "kernel")


def _open_in_viewer(path: str) -> None:
    """Starts what the system shows pictures with, where it has a display."""
    command = "open" if sys.platform == "darwin" else "xdg-open"
    if command == "xdg-open" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return
    try:
        subprocess.Popen([command, path], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                         stderr=subprocess.DEVNULL, start_new_session=True)
    except OSError:  # no such program
        pass
