#!/usr/bin/env python3
"""Writes src/common/light/sky/sunsky_data.cpp.

The sky is the RGB data set of Hosek and Wilkie (2012, 'An Analytic Model for Full Spectral Sky-Dome
Radiance'), which the Python package `mitsuba` brings along with its licence. The sun's irradiance
is measured: the radiance that the package's `sunsky` plugin shows in the sun's middle, times the
sun's solid angle.

Usage: scripts/bake_sunsky.py > src/common/light/sky/sunsky_data.cpp; clang-format-14 -i that file
"""
import struct
import textwrap
from pathlib import Path

import mitsuba
import numpy as np

mitsuba.set_variant("scalar_rgb")

FOLDER = Path(mitsuba.__file__).parent / "data" / "sunsky"
CIE_Y = 106.7502593994  # the plugin divides by this: the integral of y(lambda), nearly
APERTURE = 0.5358  # degrees
NODES = 129


def read_fields(path):
    """The float64 arrays of a Mitsuba tensor file, by name."""
    data = path.read_bytes()
    fields, at = {}, 18
    for _ in range(struct.unpack_from("<I", data, 14)[0]):
        (length,) = struct.unpack_from("<H", data, at)
        name = data[at + 2:at + 2 + length].decode()
        at += 2 + length
        dimensions, kind, offset = struct.unpack_from("<HBQ", data, at)
        shape = struct.unpack_from(f"<{dimensions}Q", data, at + 11)
        at += 11 + 8 * dimensions
        if kind != 11:
            raise SystemExit(f"{path}: {name}: expected float64 numbers")
        count = int(np.prod(shape))
        fields[name] = np.frombuffer(data, "<f8", count, offset).reshape(shape)
    return fields


def sun_irradiance(turbidity, elevation):
    """RGB, across the sun's rays."""
    direction = [0, float(np.cos(elevation)), float(np.sin(elevation))]
    # Below the horizon there is no sun: a little above it.
    direction[2] = max(direction[2], 1e-6)
    plugin = mitsuba.load_dict({"type": "sunsky", "sun_direction": direction, "sky_scale": 0.0,
                                "turbidity": turbidity, "sun_aperture": APERTURE})
    point = mitsuba.SurfaceInteraction3f()
    point.wi = -mitsuba.Vector3f(direction)
    return np.array(plugin.eval(point)) * 2 * np.pi * (1 - np.cos(np.radians(APERTURE / 2)))


def wrap(text, indent):
    return "\n".join(textwrap.wrap(text, 99, subsequent_indent=indent))


def array(name, dimensions, values):
    numbers = ", ".join(f"{v:.8g}" for v in np.asarray(values).ravel())
    # A plain list: aggregates of many dimensions are slow to compile.
    numbers = ", ".join(n if any(c in n for c in ".en") else n + ".0" for n in numbers.split(", "))
    return wrap(f"const float {name}[{dimensions}] = {{{numbers}}};", "    ") + "\n"


def main():
    licence = (FOLDER / "LICENSE").read_text().strip().splitlines()
    fields = read_fields(FOLDER / "sunsky_datasets.bin")
    suns = [[sun_irradiance(t, 0.5 * np.pi * (i / (NODES - 1)) ** 3) for i in range(NODES)]
            for t in range(1, 11)]
    print("// Made by scripts/bake_sunsky.py, which says from what. The sky's numbers come under "
          "this\n// notice:\n//")
    for line in licence:
        print(wrap("// " + line, "// ").rstrip() or "//")
    print('#include "common/light/sky/sunsky.h"\n\nnamespace pt::sunsky {\n')
    print("// clang-format off")
    print(array("sky_shapes", "10 * 2 * 6 * 3 * 9", fields["sky_params_rgb"]))
    print(array("sky_radiances", "10 * 2 * 6 * 3", fields["sky_rad_rgb"] / CIE_Y))
    print(array("sun_irradiances", "10 * sun_node_count * 3", suns))
    print("// clang-format on\n\n}  // namespace pt::sunsky")


if __name__ == "__main__":
    main()
