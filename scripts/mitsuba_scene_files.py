"""Pictures, volumes and a mesh that the scenes of scripts/mitsuba_scenes.py name."""
import math
import struct
import zlib

import numpy


def pictures():
    """Name -> rows of pixels, no two alike."""
    x, y = numpy.meshgrid(numpy.arange(8), numpy.arange(6))
    waves = numpy.sin(x * 2.1) * numpy.cos(y * 1.7) * 0.5 + 0.5
    slope = numpy.stack([0.9 * numpy.sin(x * 1.3 + y), 0.7 * numpy.cos(x - 2.0 * y),
                         numpy.ones(x.shape)], axis=2)
    a, b = numpy.meshgrid(numpy.arange(16), numpy.arange(8))
    bright = 6.0 * ((a > 3) & (a < 7) & (b > 1) & (b < 4))
    color = numpy.stack([0.05 + 0.85 * x / 7, 0.85 - 0.12 * y, 0.1 + 0.8 * ((x + 2 * y) % 3 == 0)],
                        axis=2)
    return {"picture.exr": color, "picture.png": color,
            "grey.exr": numpy.repeat(0.15 + 0.8 * ((x * 3 + y * 5) % 7 / 6)[..., None], 3, axis=2),
            "hills.exr": numpy.repeat(waves[..., None], 3, axis=2),
            "normals.exr": 0.5 + 0.5 * slope / numpy.linalg.norm(slope, axis=2, keepdims=True),
            "poles.exr": (0.5 + 0.1 * a + 30.0 * (b == 0) + 20.0 * (b == 7))[..., None]
                         * [1, 0.8, 0.5],
            "sky.exr": numpy.stack([0.3 + 0.5 * (a % 5) + bright, 0.5 + 0.1 * a + bright,
                                    1.5 - 0.1 * (a % 7) + 0.1 * b], axis=2)}


def patch_vertices(side=5):
    """A hilly square: rows of position, normal, (u, v), and triangles."""
    rows = []
    for j in range(side):
        for i in range(side):
            x, y = 2 * i / (side - 1) - 1, 2 * j / (side - 1) - 1
            z = 0.25 * math.sin(2 * x + 1) * math.cos(1.5 * y)
            n = [-0.5 * math.cos(2 * x + 1) * math.cos(1.5 * y),
                 0.375 * math.sin(2 * x + 1) * math.sin(1.5 * y), 1]
            n = [c / math.sqrt(sum(m * m for m in n)) for c in n]
            rows.append([x, y, z, *n, (i + 0.3 * j) / side, j / side])
    corner = [j * side + i for j in range(side - 1) for i in range(side - 1)]
    faces = [f for c in corner for f in ((c, c + 1, c + side + 1), (c, c + side + 1, c + side))]
    return numpy.round(rows, 4), faces


def patch_ply(rows, faces):
    names = "".join(f"property float {name}\n" for name in "x y z nx ny nz u v".split())
    head = (f"ply\nformat ascii 1.0\nelement vertex {len(rows)}\n{names}element face {len(faces)}\n"
            "property list uchar int vertex_indices\nend_header\n")
    lines = [" ".join(f"{v:g}" for v in row) for row in rows]
    return (head + "\n".join(lines + [f"3 {a} {b} {c}" for a, b, c in faces]) + "\n").encode()


def patch_obj(rows, faces):
    def lines(name, first, last):
        return "".join(f"{name} {' '.join(f'{v:g}' for v in row[first:last])}\n" for row in rows)

    corners = "".join("f " + " ".join(f"{i + 1}/{i + 1}/{i + 1}" for i in f) + "\n" for f in faces)
    return (lines("v", 0, 3) + lines("vn", 3, 6) + lines("vt", 6, 8) + corners).encode()


def patch_serialized(rows, faces):
    """Version 4 of Mitsuba's own format, floats with normals and coordinates."""
    body = struct.pack("<I", 0x0001 | 0x0002 | 0x1000) + b"patch\0"
    body += struct.pack("<QQ", len(rows), len(faces))
    for part in (rows[:, 0:3], rows[:, 3:6], rows[:, 6:8]):
        body += part.astype("<f4").tobytes()
    body += numpy.array(faces, dtype="<u4").tobytes()
    head = struct.pack("<HH", 0x041c, 4)
    return head + zlib.compress(body, 9) + struct.pack("<QI", 0, 1)


def meshes():
    """Name -> bytes."""
    rows, faces = patch_vertices()
    return {"patch.ply": patch_ply(rows, faces), "patch.obj": patch_obj(rows, faces),
            "patch.serialized": patch_serialized(rows, faces)}


def vol(values, low, high):
    """Mitsuba's .vol, version 3, of an array by z, y, x and channel; the box is between corners."""
    z, y, x, channels = values.shape
    head = struct.pack("<3sB5i6f", b"VOL", 3, 1, x, y, z, channels, *low, *high)
    return head + numpy.round(values, 3).astype("<f4").tobytes()


def voxel_middles(x, y, z):
    """Their coordinates from -1 to 1, as three arrays by z, y and x."""
    def middles(count):
        return (2 * numpy.arange(count) + 1) / count - 1

    c, b, a = numpy.meshgrid(middles(z), middles(y), middles(x), indexing="ij")
    return a, b, c


def volumes():
    """Name -> bytes. None has a symmetry that would hide a confusion of its axes."""
    a, b, c = voxel_middles(12, 10, 8)
    puffs = sum(numpy.maximum(0, height - ((a - x) ** 2 + (b - y) ** 2 + (c - z) ** 2) / size)
                for x, y, z, size, height in ((-0.5, -0.4, 0.1, 0.5, 1.0),
                                              (0.5, 0.2, -0.3, 1.0, 0.6),
                                              (-0.1, 0.8, 0.5, 0.8, 0.8)))
    a2, b2, c2 = voxel_middles(5, 4, 3)
    colors = numpy.stack([0.5 + 0.45 * numpy.sin(2 * a2 + b2), 0.5 - 0.4 * b2 * c2,
                          0.55 + 0.4 * numpy.cos(3 * c2 - a2 + 1)], axis=3)
    a3, b3, c3 = voxel_middles(12, 12, 12)
    radius = numpy.sqrt(a3 * a3 + b3 * b3 + c3 * c3)
    shell = numpy.where((radius > 0.6) & (radius < 0.85), 1.0 + 0.3 * a3, 0.0)
    return {"puffs.vol": vol(puffs[..., None], (-2, -1, -1), (2, 3, 1)),
            "colors.vol": vol(colors, (0, 0, 0), (1, 1, 1)),
            "shell.vol": vol(shell[..., None], (0, 0, 0), (1, 1, 1))}
