"""Writes a scene of any number of lights: a floor below a ceiling of lamps, a triangle each."""
import array
import math
import struct
import sys

WIDTH, HEIGHT = 20.0, 2.0  # of the ceiling
SHARE = 0.01  # of the ceiling that shines, whatever the number
SCENE = """<scene version="3.0.0">
  <sensor type="perspective"><float name="fov" value="60"/>
    <transform name="to_world"><lookat origin="0,1.5,-9" target="0,0.5,0" up="0,1,0"/></transform>
  </sensor>
  <shape type="rectangle"><bsdf type="diffuse"/>
    <transform name="to_world"><rotate x="1" angle="-90"/><scale value="10"/></transform></shape>
  <shape type="ply"><string name="filename" value="lamps.ply"/>
    <emitter type="area"><rgb name="radiance" value="30"/></emitter></shape>
</scene>
"""
HEADER = """ply
format binary_little_endian 1.0
element vertex {vertices}
property float x
property float y
property float z
element face {faces}
property list uchar int vertex_indices
end_header
"""


def lamps_ply(count):
    """The bytes of a mesh of `count` triangles that look down, one in each cell of a grid."""
    cells = math.isqrt(count - 1) + 1
    size = math.sqrt(2 * SHARE * WIDTH**2 / count)
    corners = array.array("f")
    for number in range(count):
        x, z = ((cell + 0.5) * WIDTH / cells - WIDTH / 2 - size / 2
                for cell in (number % cells, number // cells))
        corners.extend((x, HEIGHT, z, x + size, HEIGHT, z, x, HEIGHT, z + size))
    if sys.byteorder == "big":
        corners.byteswap()
    faces = (struct.pack("<Biii", 3, n, n + 1, n + 2) for n in range(0, 3 * count, 3))
    return HEADER.format(vertices=3 * count, faces=count).encode() + corners.tobytes() + b"".join(
        faces)


def write_lamp_scene(path, count):
    """The scene file `path`, in a folder of its own, with the mesh beside it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    (path.parent / "lamps.ply").write_bytes(lamps_ply(count))
    path.write_text(SCENE, encoding="utf-8")
