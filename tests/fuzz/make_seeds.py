#!/usr/bin/env python3
"""Writes a small valid file of each kind for the fuzz targets to begin with.

Usage: make_seeds.py FOLDER      fills FOLDER/ply, FOLDER/obj, ..., named as the targets are
"""
import struct
import sys
import zlib
from pathlib import Path

PLY_PROPERTIES = """element vertex 4
property float x
property float y
property float z
property float nx
property float ny
property float nz
property float u
property float v
element face 2
property list uchar int vertex_indices
end_header
"""
VERTICES = [(x, y, 0.5, 0, 0, 1, x, y) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
FACES = [(0, 1, 2), (0, 2, 3)]


def ply(encoding):
    header = f"ply\nformat {encoding} 1.0\n{PLY_PROPERTIES}".encode()
    if encoding == "ascii":
        rows = [*VERTICES, *((3, *face) for face in FACES), (4, 0, 1, 2, 3)]
        return (header.replace(b"face 2", b"face 3") +
                "".join(" ".join(map(str, row)) + "\n" for row in rows).encode())
    order = "<" if "little" in encoding else ">"
    return (header + b"".join(struct.pack(order + "8f", *vertex) for vertex in VERTICES) +
            b"".join(struct.pack(order + "B3i", 3, *face) for face in FACES))


OBJ = b"""mtllib a.mtl
v 0 0 0
v 1 0 0
v 1 1 0 1.0
v 0 1 1e-3 0.5 0.5 0.5
vt 0 0
vt 1 1 0
vn 0 0 1
usemtl red
f 1/1/1 2/2/1 3/1/1 4/2/1
f -1//-1 -2//1 -3//1
f 1/1 2/1 \\
 3/1
g group
f 1 2 3
"""

MTL = b"""newmtl red
Kd 0.8 0.1 0.1
Ks 0.5 0.5 0.5
Ke 1 2 3
Ns 100
Ni 1.5
d 0.3
illum 7
Tr 0.5
Pr 0.5
Pm 0.9
map_Kd -blendu on -s 1 2 3 -o 0 0 0 -clamp on -bm 0.5 a b.png
map_Ke glow.jpg
map_bump -imfchan r bump.png
norm n.png
newmtl two
Kd 1 1 1
"""


def serialized(version, double):
    number = "d" if double else "f"
    shapes = []
    for _ in range(2):
        body = struct.pack("<I", 0xb | (0x2000 if double else 0x1000))
        body += b"name\0" if version == 4 else b""
        body += struct.pack("<QQ", 3, 1)
        body += struct.pack(f"<{3 * 11}{number}", *range(3 * 11)) + struct.pack("<3I", 0, 1, 2)
        shapes.append(struct.pack("<HH", 0x041c, version) + zlib.compress(body))
    table = struct.pack("<2Q" if version == 4 else "<2I", 0, len(shapes[0]))
    return b"".join(shapes) + table + struct.pack("<I", 2)


def png(color_type, depth, channels, interlace=0):
    def chunk(name, data):
        return (struct.pack(">I", len(data)) + name + data +
                struct.pack(">I", zlib.crc32(name + data)))
    header = struct.pack(">IIBBBBB", 3, 2, depth, color_type, 0, 0, interlace)
    rows = b"".join(b"\0" + bytes(range(3 * channels * depth // 8)) for _ in range(2))
    palette = chunk(b"PLTE", bytes(range(256)) * 3) if color_type == 3 else b""
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + palette +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def bmp():
    return (b"BM" + struct.pack("<III", 70, 0, 54) +
            struct.pack("<IiiHHIIiiII", 40, 2, 2, 1, 24, 0, 0, 0, 0, 0, 0) + bytes(range(16)))


def tga(kind, depth):
    pixels = bytes(range(4 * depth // 8)) if kind < 8 else b"\x83" + bytes(depth // 8)
    return bytes([0, 0, kind]) + bytes(9) + struct.pack("<HHBB", 2, 2, depth, 0x20) + pixels


def jpeg(progressive):
    one_code = bytes([1] + [0] * 15)
    frame = bytes([8, 0, 8, 0, 8, 1, 1, 0x11, 0])

    def segment(marker, data):
        return bytes([0xff, marker]) + struct.pack(">H", len(data) + 2) + data
    return (b"\xff\xd8" + segment(0xdb, b"\0" + bytes([8] * 64)) +
            segment(0xc2 if progressive else 0xc0, frame) +
            segment(0xc4, b"\x00" + one_code + b"\x07") + segment(0xc4, b"\x10" + one_code + b"\0") +
            segment(0xda, bytes([1, 1, 0, 0, 0 if progressive else 63, 0])) +
            b"\x48\x7f\xff\xd9")


def hdr():
    flat = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" + bytes(range(120, 128))
    runs = (b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n\x02\x02\x00\x08" +
            b"\x88\x40" * 2 + b"\x08" + bytes(range(8)) + b"\x88\x80")
    return flat, runs


def exr():
    def attribute(name, kind, data):
        return name + b"\0" + kind + b"\0" + struct.pack("<I", len(data)) + data
    channels = b"".join(name + b"\0" + struct.pack("<IIII", 2, 0, 1, 1) for name in (b"B", b"G", b"R"))
    box = struct.pack("<iiii", 0, 0, 1, 0)
    header = (b"\x76\x2f\x31\x01\x02\0\0\0" + attribute(b"channels", b"chlist", channels + b"\0") +
              attribute(b"compression", b"compression", b"\0") +
              attribute(b"dataWindow", b"box2i", box) + attribute(b"displayWindow", b"box2i", box) +
              attribute(b"lineOrder", b"lineOrder", b"\0") +
              attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1)) +
              attribute(b"screenWindowCenter", b"v2f", struct.pack("<ff", 0, 0)) +
              attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + b"\0")
    line = struct.pack("<6f", *range(6))
    return header + struct.pack("<Q", len(header) + 8) + struct.pack("<iI", 0, len(line)) + line


SEEDS = {
    "ply": [ply(e) for e in ("ascii", "binary_little_endian", "binary_big_endian")],
    "obj": [OBJ],
    "mtl": [MTL],
    "serialized": [serialized(v, d) for v in (3, 4) for d in (False, True)],
    "image": [png(0, 8, 1), png(2, 8, 3), png(6, 16, 4, 1), png(3, 8, 1), png(4, 8, 2), bmp(),
              tga(2, 24), tga(10, 32), tga(3, 8), jpeg(False), jpeg(True), *hdr(), exr()],
}


def main(arguments):
    if len(arguments) != 1 or arguments[0].startswith("-"):
        print(__doc__.strip())
        return 2
    for name, files in SEEDS.items():
        folder = Path(arguments[0], name)
        folder.mkdir(parents=True, exist_ok=True)
        for number, data in enumerate(files):
            (folder / f"seed{number}").write_bytes(data)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
