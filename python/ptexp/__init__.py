"""ptexp: a path tracer for research on how to execute path tracing.

>>> import ptexp
>>> scene = ptexp.load("cornell", width=256, height=256)
>>> image = ptexp.render(scene, mode="wavefront", spp=64, seed=1)
>>> image.array.shape
(256, 256, 3)

All modes give the same bits on a device. docs/python.md is the manual.
"""
from . import _ptexp
from ._advise import Advice, AdvisedWay, Calibration, advise, calibrate
from ._errors import Error, OptionError, SceneWarning
from ._image import Image, Layers, denoise, write_image
from ._measure import ModeComparison, compare_modes, measure, sweep
from ._params import Params
from ._scene import DeviceInfo, Scene, SceneInfo, devices, explain, load, load_string, options, render, scenes
from ._table import Table
from ._trace import Comparison, Hits, Mesh, compare, read_image, trace

__version__ = _ptexp.build_info()["version"]


def build_info() -> dict:
    """Version, commit, compiler, and the CUDA that the module was built with ("off": none)."""
    return _ptexp.build_info()


__all__ = [
    "Advice", "AdvisedWay", "Calibration", "Comparison", "DeviceInfo", "Error", "Hits", "Image", "Layers", "Mesh",
    "ModeComparison", "OptionError", "Params", "Scene", "SceneInfo", "SceneWarning", "Table", "advise", "build_info",
    "calibrate", "compare", "compare_modes", "denoise", "devices", "explain", "load", "load_string", "measure",
    "options", "read_image", "render", "scenes", "sweep", "trace", "write_image",
]
