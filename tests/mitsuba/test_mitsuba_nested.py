"""Materials made of materials against Mitsuba 3: two sides, blends, normal and bump maps, masks.

Each scene is one card or one round mesh with coordinates over a floor, under two lamps, so that
front, back and what shines through are seen. Mitsuba counts a passage through a mask as a bounce,
ptexp does not: both get enough of them that the rest does not matter.

Skips as test_mitsuba_pairs.py does, which has the comparison.
"""
import tempfile
import unittest
from pathlib import Path

import test_mitsuba_pairs as pairs
from mitsuba_package import mi, np
from test_mitsuba_pairs import GREY, SMALL, TWO_SIDED, WIDE, floor, lamp, shape

DEEP = 24  # rays of a path; nothing returns half of the light that often
RED, BLUE = GREY.format("0.8 0.3 0.1"), GREY.format("0.1 0.3 0.8")
GLASS = ('<bsdf type="dielectric"><float name="int_ior" value="1.5"/>'
         '<float name="ext_ior" value="1"/></bsdf>')
TILT = '<rotate x="1" angle="35"/><rotate z="1" angle="20"/><translate z="0.9"/>'
TURNED = '<rotate x="1" angle="215"/><rotate z="1" angle="20"/><translate z="0.9"/>'
# A ridge with smooth normals; its coordinates are turned and mirrored on one side.
RIDGE = """v -1.2 -1 0
v -1.2 1 0
v 0 -1 0.8
v 0 1 0.8
v 1.2 -1 0
v 1.2 1 0
vt 0 0
vt 0 1
vt 0.7 0.1
vt 0.8 1
vt 0.2 0.3
vt 0.1 0.9
vn -0.6 0 0.8
vn 0 0 1
vn 0.6 0 0.8
f 1/1/1 3/3/2 4/4/2
f 1/1/1 4/4/2 2/2/1
f 3/3/2 5/5/3 6/6/3
f 3/3/2 6/6/3 4/4/2
"""


def bitmap(file, name="", inside=""):
    return (f'<texture type="bitmap" name="{name}"><string name="filename" value="{file}"/>'
            f'<boolean name="raw" value="true"/>{inside}</texture>')


def card(bsdf, transform=TILT):
    return shape("rectangle", transform, bsdf)


def ridge(bsdf):
    return shape("obj", '<rotate z="1" angle="25"/><translate z="0.2"/>',
                 '<string name="filename" value="ridge.obj"/>' + bsdf)


def wrap(kind, *inside):
    return f'<bsdf type="{kind}">{"".join(inside)}</bsdf>'


def number(name, value):
    return f'<float name="{name}" value="{value}"/>'


LAMPS = lamp(WIDE, "6 4 3") + lamp(SMALL, "2 9 4") + lamp(
    '<scale value="0.4"/><rotate x="1" angle="180"/><translate x="0.3" z="0.1"/>', "9 3 2")
STAGE = floor() + LAMPS
BUMPS = ("bumpmap", bitmap("hills.exr"), number("scale", "0.3"))
NORMALS = ("normalmap", bitmap("normals.exr", "normalmap"))
OLD = ('<boolean name="use_shadowing_function" value="false"/>'
       '<boolean name="flip_invalid_normals" value="false"/>')

SCENES = {
    "a card with two sides": card(wrap("twosided", RED, BLUE)),
    "the same, from its back": card(wrap("twosided", RED, BLUE), TURNED),
    "a blend of two colours": card(wrap("blendbsdf", number("weight", "0.3"),
                                        TWO_SIDED.format(RED), TWO_SIDED.format(BLUE))),
    "a blend by a texture, two-sided": card(wrap("twosided", wrap(
        "blendbsdf", bitmap("picture.exr", "weight"), RED, BLUE)), TURNED),
    "a blend of a blend and glass": card(wrap(
        "blendbsdf", bitmap("picture.exr", "weight"), GLASS, wrap(
            "blendbsdf", number("weight", "0.6"), TWO_SIDED.format(RED), BLUE))),
    "normal map": card(wrap(*NORMALS, RED)),
    "normal map without its repairs": card(wrap(*NORMALS, OLD, RED)),
    "normal map within two sides, from behind": card(wrap("twosided", wrap(*NORMALS, RED)), TURNED),
    "normal map around two sides, from behind": card(wrap(*NORMALS, TWO_SIDED.format(RED)), TURNED),
    "normal map on glass": card(wrap(*NORMALS, GLASS)),
    "normal map on a ridge": ridge(wrap("twosided", wrap(*NORMALS, RED))),
    "bump map": card(wrap(*BUMPS, RED)),
    "bump map without its repairs": card(wrap(*BUMPS, OLD, RED)),
    "bump map within two sides, from behind": card(wrap("twosided", wrap(*BUMPS, RED)), TURNED),
    "bump map on a ridge": ridge(wrap("twosided", wrap(*BUMPS, RED))),
    "bump map with a transform": card(wrap("bumpmap", bitmap("hills.exr", "", (
        '<transform name="to_uv"><rotate z="1" angle="30"/><scale x="0.7" y="1.6"/></transform>'
        '<string name="wrap_mode" value="mirror"/>')), RED)),
}
MASKED = {
    "a mask of one opacity": card(wrap("mask", number("opacity", "0.35"), TWO_SIDED.format(RED))),
    "a textured mask": card(wrap("mask", bitmap("grey.exr", "opacity"), TWO_SIDED.format(RED))),
    "a mask around a blend": card(wrap("mask", bitmap("grey.exr", "opacity"), wrap(
        "blendbsdf", number("weight", "0.3"), TWO_SIDED.format(RED), TWO_SIDED.format(BLUE)))),
    "a blend with nothing": card(wrap("blendbsdf", bitmap("grey.exr", "weight"),
                                      TWO_SIDED.format(RED), '<bsdf type="null"/>')),
    "two masked cards": card(wrap("mask", bitmap("grey.exr", "opacity"), TWO_SIDED.format(RED)))
        + card(wrap("mask", number("opacity", "0.5"), TWO_SIDED.format(BLUE)),
               '<translate z="0.3"/>'),
    "a masked sphere": shape("sphere", '<scale value="0.7"/><translate z="0.8"/>', wrap(
        "mask", number("opacity", "0.5"), TWO_SIDED.format(RED))),
}


def write_textures(folder):
    def save(name, rows):
        mi.Bitmap(np.array(rows, dtype=np.float32)).write(str(folder / name))

    x, y = np.meshgrid(np.arange(8), np.arange(6))
    save("grey.exr", np.repeat(((x * 3 + y * 5) % 7 / 6)[..., None], 3, axis=2))
    save("hills.exr", np.repeat((np.sin(x * 2.1) * np.cos(y * 1.7) * 0.5 + 0.5)[..., None], 3,
                                axis=2))
    slope = np.stack([0.9 * np.sin(x * 1.3 + y), 0.7 * np.cos(x - 2.0 * y), np.ones(x.shape)],
                     axis=2)
    save("normals.exr", 0.5 + 0.5 * slope / np.linalg.norm(slope, axis=2, keepdims=True))
    (folder / "ridge.obj").write_text(RIDGE)


@unittest.skipIf(mi is None, "the Python package mitsuba is not installed")
@unittest.skipUnless(Path(pairs.PROGRAM).exists(), f"{pairs.PROGRAM} is not built")
class Nested(unittest.TestCase):
    def compare(self, inside, depth):
        with tempfile.TemporaryDirectory() as name_of_folder:
            folder = Path(name_of_folder)
            pairs.DEPTH, pairs.SPP = depth, min(pairs.SPP, 128)
            path = pairs.write_scene(folder, inside + STAGE)
            write_textures(folder)
            pairs.Pairs.check(self, pairs.our_images(path, folder, "on"), pairs.their_images(path))

    def test_materials(self):
        for name, inside in SCENES.items():
            with self.subTest(name):
                self.compare(inside, 4)

    def test_masks(self):
        for name, inside in MASKED.items():
            with self.subTest(name):
                self.compare(inside, DEEP)


if __name__ == "__main__":
    unittest.main()
