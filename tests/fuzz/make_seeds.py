#!/usr/bin/env python3
"""Writes a small valid file of each kind for the fuzz targets to begin with.

Usage: make_seeds.py FOLDER      fills FOLDER/ply, FOLDER/obj, ..., named as the targets are, and
                                FOLDER/files with what the scenes among them name
"""
import base64
import json
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


def vol(channels):
    head = struct.pack("<3sB5i6f", b"VOL", 3, 1, 2, 3, 1, channels, -1, -1, -1, 1, 2, 3)
    return head + struct.pack(f"<{6 * channels}f", *range(6 * channels))


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


def exr(numbers=None, texts=None):
    """2x1 pixels, with channels of whole numbers ({name: (left, right)}) and string attributes."""
    numbers, texts = numbers or {}, texts or {}

    def attribute(name, kind, data):
        return name + b"\0" + kind + b"\0" + struct.pack("<I", len(data)) + data
    floats = {b"B": (0, 1), b"G": (2, 3), b"R": (4, 5)}
    names = sorted([*floats, *numbers])
    channels = b"".join(name + b"\0" + struct.pack("<IIII", 2 if name in floats else 0, 0, 1, 1)
                        for name in names)
    box = struct.pack("<iiii", 0, 0, 1, 0)
    header = (b"\x76\x2f\x31\x01\x02\0\0\0" + attribute(b"channels", b"chlist", channels + b"\0") +
              attribute(b"compression", b"compression", b"\0") +
              attribute(b"dataWindow", b"box2i", box) + attribute(b"displayWindow", b"box2i", box) +
              attribute(b"lineOrder", b"lineOrder", b"\0") +
              attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1)) +
              attribute(b"screenWindowCenter", b"v2f", struct.pack("<ff", 0, 0)) +
              attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) +
              b"".join(attribute(key, b"string", text) for key, text in texts.items()) + b"\0")
    line = b"".join(struct.pack("<2f", *floats[name]) if name in floats else
                    struct.pack("<2I", *numbers[name]) for name in names)
    return header + struct.pack("<Q", len(header) + 8) + struct.pack("<iI", 0, len(line)) + line


def checkpoint(moments):
    """Two pixels of which the left one has 3 samples."""
    pixels = struct.pack("<3dQ3dQ", 1, 2, 3, 3, 0, 0, 0, 0)
    more = struct.pack("<dQQdQQ", 4, 5, 6, 0, 0, 0) if moments else b""
    numbers = {}
    for layer, channels, at, data in (("sum", "RGB", 0, pixels), ("samples", "N", 24, pixels),
                                      ("luminance_squares", "Y", 0, more), ("rays", "CS", 8, more)):
        size = len(data) // 2
        for c, letter in enumerate(channels if data else ""):
            pair = [struct.unpack_from("<II", data, at + 8 * c + size * x) for x in range(2)]
            for half, name in ((1, "high"), (0, "low")):
                numbers[f"film.{layer}.{name}.{letter}".encode()] = [p[half] for p in pair]
    texts = {"format": "1", "window": "0 0 2 1", "aovs": "", "plan": f"{int(moments)} 0",
             "parts": "0 0 1 1 0 3", "tally": "5 6 0 3" + " 0" * 127,
             "checksum": str(zlib.crc32(pixels + more))}
    texts = {f"ptexp.film.{key}".encode(): text.encode() for key, text in texts.items()}
    header = b"".join(key + b"\0" + texts[key] + b"\0" for key in sorted(texts))
    texts[b"ptexp.film.header_checksum"] = str(zlib.crc32(header)).encode()
    return exr(numbers, texts)


def rays():
    mesh = b"TRBMESH1" + struct.pack("<II9f3I", 3, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 2)
    ray = b"TRBRAYS1" + struct.pack("<QI12x8f", 1, 0, 0, 0, 0, 0, 0, 0, 1, 9)
    hit = b"TRBHITS1" + struct.pack("<QI12xfIff", 1, 0, 1.5, 0, 0.25, 0.25)
    return mesh, ray, hit


def unit():
    """Guesses at the layout of unit_message.h; the fuzzer mends them."""
    window = struct.pack("<4I", 0, 0, 1, 1)
    film = window + struct.pack("<2I", 0, 1) + struct.pack("<Q", 1) + window
    film += struct.pack("<Q3dQ", 1, 1, 2, 3, 1) + struct.pack("<QQ", 0, 0) + bytes(8 * 131)
    return struct.pack("<Q", 7) + film + struct.pack("<I", 4), bytes(2048)


XML_START = b"""<?xml version="1.0"?>
<scene version="3.0.0"><default name="spp" value="4"/><integrator type="path">
<integer name="max_depth" value="7"/></integrator>
<sensor type="perspective"><float name="fov" value="40"/><string name="fov_axis" value="x"/>
<transform name="to_world"><lookat origin="0,1,5" target="0 0 0" up="0,1,0"/></transform>
<sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
<film type="hdrfilm"><integer name="width" value="64"/><integer name="height" value="32"/></film>
</sensor>
"""
XML_PARTS = [b"""<bsdf type="twosided" id="wood"><bsdf type="diffuse">
<texture name="reflectance" type="bitmap"><string name="filename" value="a.png"/>
<transform name="to_uv"><scale x="2" y="3"/></transform></texture></bsdf></bsdf>
<bsdf type="dielectric" id="glass"><float name="int_ior" value="1.5"/></bsdf>
<bsdf type="roughconductor" id="gold"><string name="material" value="Au"/>
<float name="alpha" value="0.1"/></bsdf>
<shape type="obj"><string name="filename" value="a.obj"/><ref id="wood"/>
<transform name="to_world"><rotate y="1" angle="30"/><translate x="1"/></transform></shape>
<shape type="ply"><string name="filename" value="a.ply"/><ref id="glass"/></shape>
<shape type="serialized"><string name="filename" value="a.serialized"/>
<integer name="shape_index" value="1"/><ref id="gold"/></shape>
<emitter type="constant"><rgb name="radiance" value="0.5 1 1"/></emitter>
""", b"""<shape type="rectangle"><emitter type="area"><spectrum name="radiance" value="400:1, 700:2"/>
</emitter></shape><shape type="sphere"><point name="center" x="0" y="1" z="2"/>
<float name="radius" value="0.5"/><bsdf type="plastic"><rgb name="diffuse_reflectance"
value="#ff8000"/></bsdf></shape><shape type="cube"><bsdf type="conductor"/></shape>
<shape type="cylinder"/><shape type="disk"><transform name="to_world"><matrix
value="1 0 0 0 0 2 0 0 0 0 3 0 0 0 0 1"/></transform></shape>
<emitter type="envmap"><string name="filename" value="a.hdr"/></emitter>
<emitter type="point"><rgb name="intensity" value="1"/><point name="position" value="1 2 3"/>
</emitter><emitter type="spot"/><emitter type="directional"><vector name="direction" value="0 0 1"/>
</emitter>
""", b"""<shape type="shapegroup" id="group"><shape type="sphere"/></shape>
<shape type="instance"><ref id="group"/></shape><include filename="b.xml"/>
<alias id="wood" as="timber"/><shape type="cube"><bsdf type="blendbsdf"><float name="weight"
value="0.3"/><bsdf type="diffuse"/><bsdf type="mask"><bsdf type="principled"/></bsdf></bsdf>
<texture type="checkerboard" name="color"/></shape>
""", b"""<medium type="heterogeneous" id="cloud"><volume type="gridvolume" name="sigma_t">
<string name="filename" value="a.vol"/><boolean name="use_grid_bbox" value="true"/>
<string name="filter_type" value="nearest"/></volume><float name="scale" value="3"/>
<volume type="constvolume" name="albedo"><float name="value" value="0.5"/></volume>
<phase type="hg"><float name="g" value="0.5"/></phase></medium>
<shape type="sphere"><ref id="cloud" name="interior"/></shape>
<shape type="cube"><bsdf type="null"/><medium type="homogeneous" name="interior"/></shape>
"""]


PBRT_START = b"""Scale -1 1 1 LookAt 0 1 5 0 0 0 0 1 0
Camera "perspective" "float fov" 40 # a comment
Film "rgb" "integer xresolution" 64 "integer yresolution" [ 32 ] "float iso" 200
Sampler "halton" "integer pixelsamples" 4 PixelFilter "gaussian" Integrator "path"
WorldBegin
"""
PBRT_PARTS = [b"""LightSource "infinite" "string filename" "a.hdr"
Texture "t" "spectrum" "imagemap" "string filename" "a.png" "bool invert" true
Texture "f" "float" "checkerboard" "float tex1" 0.5 Texture "s" "spectrum" "scale" "texture tex" "t"
"texture scale" "f" Texture "m" "spectrum" "mix" "texture tex1" "t" "texture tex2" "s"
MakeNamedMaterial "d" "string type" "diffuse" "texture reflectance" "m"
MakeNamedMaterial "c" "string type" "coateddiffuse" "float roughness" 0.1
Material "mix" "string materials" [ "d" "c" ] "float amount" 0.3
AttributeBegin Translate 1 2 3 Rotate 30 0 1 0 Shape "sphere" "texture alpha" "f" AttributeEnd
Shape "plymesh" "string filename" "a.ply" Include "b.pbrt" Import "b.pbrt"
""", b"""AttributeBegin AreaLightSource "diffuse" "blackbody L" 4000 "bool twosided" true "float power" 9
Shape "disk" ReverseOrientation Shape "cylinder" "float phimax" 90 AttributeEnd
ObjectBegin "o" Shape "loopsubdiv" "integer levels" 1 "integer indices" [ 0 1 2 0 2 3 ]
"point3 P" [ 0 0 0 1 0 0 1 1 0 0 1 1 ] ObjectEnd ConcatTransform [ 1 0 0 0 0 2 0 0 0 0 1 0 0 0 0 1 ]
ObjectInstance "o" Material "conductor" "spectrum eta" "metal-Cu-eta" "rgb k" [ 1 2 3 ]
Shape "bilinearmesh" "point3 P" [ 0 0 0 1 0 0 0 1 0 1 1 1 ]
LightSource "spot" "point3 from" [ 0 1 0 ] LightSource "point" "spectrum I" [ 400 1 700 2 ]
LightSource "distant" "float illuminance" 3 Attribute "shape" "float radius" 2
Material "coatedconductor" Shape "sphere" Material "dielectric" "spectrum eta" "glass-BK7"
Shape "sphere" "float zmin" -0.5 MediumInterface "a" "b" ColorSpace "rec2020" Material "interface"
Material "diffusetransmission" Shape "trianglemesh" "point3 P" [ 0 0 0 1 0 0 1 1 0 ]
"integer indices" [ 0 1 2 ] "normal N" [ 0 0 1 0 0 1 0 0 1 ] "point2 uv" [ 0 0 1 0 1 1 ]
""", b"""Texture "t" "spectrum" "checkerboard" "string mapping" "planar" "vector3 v1" [ 0 1 0 ]
Texture "a" "float" "imagemap" "string filename" "a.png" "string mapping" "spherical"
Material "coateddiffuse" "texture reflectance" "t" "float thickness" 0.1
Shape "curve" "string type" "ribbon" "normal N" [ 0 0 1 0 1 0 ] "float width0" 0.1
"point3 P" [ 0 0 0 1 0 0 1 1 0 1 1 1 ] Shape "disk" "texture alpha" "a"
Shape "curve" "string basis" "bspline" "integer degree" 2 "point3 P" [ 0 0 0 1 0 0 1 1 0 ]
"""]


def gltf():
    vertices = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0) + struct.pack("<3H", 0, 1, 2) + b"\0\0"
    image = png(2, 8, 3)
    def uri(kind, data):
        return f"data:{kind};base64," + base64.b64encode(data).decode()
    model = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2]}],
        "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_transmission"],
        "extensions": {"KHR_lights_punctual": {"lights": [
            {"type": "spot", "spot": {"outerConeAngle": 0.7}, "intensity": 3, "color": [1, 0, 1]}]}},
        "nodes": [{"mesh": 0, "translation": [1, 2, 3], "rotation": [0, 0, 0, 1], "scale": [1, 2, 1]},
                  {"camera": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1]},
                  {"mesh": 0, "children": [3]},
                  {"extensions": {"KHR_lights_punctual": {"light": 0}}}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 0}, "indices": 1,
                                    "material": 0, "mode": 4}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0},
                                                "metallicFactor": 0.2}, "emissiveFactor": [1, 2, 3],
                       "extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.3}}}],
        "textures": [{"source": 0, "sampler": 0}], "samplers": [{"wrapS": 33071}],
        "images": [{"uri": uri("image/png", image)}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                       "min": [0, 0, 0], "max": [1, 1, 0]},
                      {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36, "byteStride": 12},
                        {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
        "buffers": [{"byteLength": len(vertices), "uri": uri("application/octet-stream", vertices)}],
    }
    text = json.dumps(model).encode()
    del model["buffers"][0]["uri"]
    model["images"] = [{"uri": "a.png"}]
    chunk = json.dumps(model).encode()
    chunk += b" " * (-len(chunk) % 4)
    glb = (b"glTF" + struct.pack("<II", 2, 28 + len(chunk) + len(vertices)) +
           struct.pack("<I", len(chunk)) + b"JSON" + chunk +
           struct.pack("<I", len(vertices)) + b"BIN\0" + vertices)
    return text, glb, animated_gltf()


def animated_gltf():
    """A skinned triangle with a morph target, all of which is animated in each way."""
    parts = {  # name: (components, type, numbers)
        "positions": ("f", "VEC3", (0, 0, 0, 1, 0, 0, 0, 1, 0)), "target": ("f", "VEC3", (0, 0, 1) * 3),
        "joints": ("B", "VEC4", (0, 1, 0, 0) * 3), "weights": ("f", "VEC4", (0.5, 0.5, 0, 0) * 3),
        "inverse": ("f", "MAT4", (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1) * 2), "keys": ("f", "SCALAR", (0, 1)),
        "turns": ("b", "VEC4", (0, 0, 0, 127, 0, 0, 127, 0)), "moves": ("f", "VEC3", (0, 1, 2) * 6),
        "morphs": ("f", "SCALAR", (0, 1)), "sizes": ("f", "VEC3", (1, 1, 1, 2, 2, 2))}
    data, views, accessors, number = b"", [], [], {}
    for name, (code, kind, values) in parts.items():
        packed = struct.pack(f"<{len(values)}{code}", *values)
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}[kind]
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(packed)})
        accessors.append({"bufferView": len(number), "componentType": {"f": 5126, "B": 5121, "b": 5120}[code],
                          "count": len(values) // width, "type": kind, "normalized": code == "b"})
        number[name] = len(number)
        data += packed
    channels = [("rotation", 1, "turns", "LINEAR"), ("translation", 2, "moves", "CUBICSPLINE"),
                ("scale", 1, "sizes", "STEP"), ("weights", 0, "morphs", "LINEAR")]
    return json.dumps({
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "skin": 0}, {"children": [2]}, {"weights": []}],
        "skins": [{"joints": [1, 2], "inverseBindMatrices": number["inverse"]}],
        "meshes": [{"weights": [1], "primitives": [{
            "attributes": {"POSITION": number["positions"], "JOINTS_0": number["joints"], "WEIGHTS_0": number["weights"]},
            "targets": [{"POSITION": number["target"]}]}]}],
        "animations": [{"name": "all",
                        "channels": [{"sampler": i, "target": {"node": node, "path": path}}
                                     for i, (path, node, _, _) in enumerate(channels)],
                        "samplers": [{"input": number["keys"], "output": number[output], "interpolation": how}
                                     for _, _, output, how in channels]}],
        "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": len(data),
                     "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}]}).encode()


def nvdb():
    """The tests' grids, unpacked: a checksum of zip's would hide what a change of a byte leads to."""
    files = []
    for path in sorted(Path(__file__).parents[1].glob("data/nanovdb/*.nvdb")):
        data = path.read_bytes()
        codec, name_size = data[14], struct.unpack_from("<I", data, 16 + 136)[0]
        begin = 16 + 176 + name_size
        if codec == 1 and data[12] == 1:  # of one grid
            grid = bytearray(zlib.decompress(data[begin + 8:]))
            grid[8:16] = b"\xff" * 8  # no checksum
            head = bytearray(data[:begin])
            head[14:16] = bytes(2)
            struct.pack_into("<Q", head, 16 + 8, len(grid))
            files.append(bytes(head + grid))
    return files


SEEDS = {
    "ply": [ply(e) for e in ("ascii", "binary_little_endian", "binary_big_endian")],
    "obj": [OBJ],
    "mtl": [MTL],
    "serialized": [serialized(v, d) for v in (3, 4) for d in (False, True)],
    "vol": [vol(1), vol(3)],
    "nvdb": nvdb(),
    "image": [png(0, 8, 1), png(2, 8, 3), png(6, 16, 4, 1), png(3, 8, 1), png(4, 8, 2), bmp(),
              tga(2, 24), tga(10, 32), tga(3, 8), jpeg(False), jpeg(True), *hdr(), exr(),
              b"P6 1 1 255\nabc", b"P5 1 1 65535\nab",
              b"PF 1 1 -1\n" + struct.pack("<3f", 1, 2, 3)],
    "mitsuba_xml": [XML_START + part + b"</scene>\n" for part in XML_PARTS],
    "pbrt": [PBRT_START + part for part in PBRT_PARTS],
    "gltf": gltf(),
    "checkpoint": [checkpoint(False), checkpoint(True)],
    "rays": rays(),
    "unit": unit(),
}

# Beside the scenes, under the names that they use.
FILES = {"a.png": png(2, 8, 3), "a.hdr": hdr()[0], "a.obj": OBJ, "a.mtl": MTL, "a.ply": ply("ascii"),
         "a.serialized": serialized(4, False), "a.vol": vol(3),
         "b.pbrt": b'Translate 1 0 0 Shape "sphere" "float radius" 0.5\n',
         "b.xml": b'<scene version="3.0.0"><bsdf type="diffuse" id="other"/></scene>'}


def main(arguments):
    if len(arguments) != 1 or arguments[0].startswith("-"):
        print(__doc__.strip())
        return 2
    for name, files in SEEDS.items():
        folder = Path(arguments[0], name)
        folder.mkdir(parents=True, exist_ok=True)
        for number, data in enumerate(files):
            (folder / f"seed{number}").write_bytes(data)
    folder = Path(arguments[0], "files")
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in FILES.items():
        (folder / name).write_bytes(data)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
