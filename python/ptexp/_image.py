"""Images in memory."""
import json
import os
from collections.abc import Mapping
from typing import Any, Dict, Iterator, Optional, Union

from . import _ptexp
from ._errors import text_of_path


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
    """

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

    def save(self, path: Union[str, "os.PathLike[str]"], *, exposure: Union[str, float, None] = None) -> None:
        """Writes an .exr (linear float, with layers), .png (sRGB) or .ppm, as the program does.

        Args:
            path: the file; its ending is the format.
            exposure: stops for a .png or .ppm, or "auto"; by default as the render was asked.

        Raises:
            Error: the file cannot be written.
            OptionError: ``exposure`` is neither.
        """
        self._native.save(text_of_path(path), "" if exposure is None else str(exposure))

    def __repr__(self) -> str:
        return f"<ptexp.Image {self.width}x{self.height}>"
