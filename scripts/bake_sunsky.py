#!/usr/bin/env python3
"""Writes data/sunsky.

The sky is the RGB data set of Hosek and Wilkie (2012, 'An Analytic Model for Full Spectral Sky-Dome
Radiance'), which the Python package `mitsuba` brings along with its licence. The sun's irradiance
is measured: the radiance that the package's `sunsky` plugin shows in the sun's middle, times the
sun's solid angle.

Usage: scripts/bake_sunsky.py
"""
import struct
from pathlib import Path

import mitsuba
import numpy as np

mitsuba.set_variant("scalar_rgb")

FOLDER = Path(mitsuba.__file__).parent / "data" / "sunsky"
CIE_Y = 106.7502593994  # the plugin divides by this: the integral of y(lambda), nearly
OUTPUT = Path(__file__).resolve().parent.parent / "data" / "sunsky"
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


def write(name, what, values):
    numbers = [f"{v:.8g}" for v in np.asarray(values).ravel()]
    numbers = [n if any(c in n for c in ".en") else n + ".0" for n in numbers]
    rows = [" ".join(numbers[i:i + 9]) for i in range(0, len(numbers), 9)]
    (OUTPUT / f"{name}.txt").write_text("\n".join([what, *rows]) + "\n")


def main():
    fields = read_fields(FOLDER / "sunsky_datasets.bin")
    suns = [[sun_irradiance(t, 0.5 * np.pi * (i / (NODES - 1)) ** 3) for i in range(NODES)]
            for t in range(1, 11)]
    (OUTPUT / "LICENSE").write_text((FOLDER / "LICENSE").read_text().strip() + "\n")
    theirs = "# Written by scripts/bake_sunsky.py. LICENSE holds for it."
    write("sky_shapes", f"""\
# The nine parameters of the sky's distribution, by turbidity (1 to 10), albedo of the ground (0, 1),
# control point over the sun's elevation (6) and channel (3).
{theirs}""", fields["sky_params_rgb"])
    write("sky_radiances", f"""\
# The sky's mean radiance, by turbidity (1 to 10), albedo of the ground (0, 1), control point over the
# sun's elevation (6) and channel (3).
{theirs}""", fields["sky_rad_rgb"] / CIE_Y)
    write("sun_irradiances", """\
# The sun's irradiance, by turbidity (1 to 10), elevation pi / 2 (i / 128)^3 and channel (3).
# Written by scripts/bake_sunsky.py.""", suns)


if __name__ == "__main__":
    main()
