"""Pairs of features against Mitsuba 3: means of whole images and every pixel, by their noise.

Each scene is a few lines of XML and joins what single tests keep apart: an environment and lamps,
a textured lamp, mirrored and stretched instances, glass and a lamp, smooth normals, a texture and
its transform. Lamps are large and close and of unequal colours, so that light in the wrong place
changes the means. Environments have the same radiance from pole to pole: rows at the poles lie
elsewhere in Mitsuba's maps. No lamp lies inside of glass.

Skips without the Python package `mitsuba`, unless PTEXP_NEEDS_MITSUBA is set. PTEXP names the
program.
"""
import math
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

from mitsuba_package import mi, np

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("PTEXP", str(ROOT / "build" / "release" / "src" / "ptexp"))
# Sanitizers take ten times as long; there the images matter less than what is done with memory.
QUICK = bool(os.environ.get("PTEXP_QUICK_TESTS"))
DEPTH, SIDE, SPP, SEEDS = 4, 24, 16 if QUICK else 256, 8
NOISE = 4e-2 if QUICK else 8e-3  # of a mean: more would say nothing

LAMP = '<emitter type="area"><rgb name="radiance" value="{}"/></emitter>'
BLACK = '<bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf>'
GREY = '<bsdf type="diffuse"><rgb name="reflectance" value="{}"/></bsdf>'
TWO_SIDED = '<bsdf type="twosided">{}</bsdf>'
BITMAP = """<texture type="bitmap" name="{}"><string name="filename" value="picture.exr"/>
    <boolean name="raw" value="true"/>{}</texture>"""
# A pyramid that pretends to be round: normals by vertex.
ROUND = """v 1 0 0
v 0 1 0
v -1 0 0
v 0 -1 0
v 0 0 1
vn 0.8 0 0.6
vn 0 0.8 0.6
vn -0.8 0 0.6
vn 0 -0.8 0.6
vn 0 0 1
f 1//1 2//2 5//5
f 2//2 3//3 5//5
f 3//3 4//4 5//5
f 4//4 1//1 5//5
"""


def shape(kind, transform, inside):
    return (f'<shape type="{kind}">{inside}<transform name="to_world">{transform}</transform>'
            "</shape>\n")


def floor(inside=TWO_SIDED.format(GREY.format("0.7 0.5 0.3"))):
    return shape("rectangle", '<scale value="4"/>', inside)


def lamp(transform, radiance, kind="rectangle"):
    """Shines along its -z before the transform."""
    return shape(kind, f'<rotate x="1" angle="180"/>{transform}',
                 BLACK + LAMP.format(radiance))


WIDE = '<scale x="1.2" y="0.6"/><rotate y="1" angle="25"/><translate x="-1.2" z="1.4"/>'
SMALL = '<scale x="0.3" y="0.5"/><rotate x="1" angle="-30"/><translate y="-1.5" z="1"/>'
MIRRORED = ('<scale x="-1.3" y="0.5"/><rotate x="0" y="1" z="0" angle="-30"/>'
            '<translate x="1.3" z="1.5"/>')
SPHERE = shape("sphere", '<scale value="0.5"/><translate x="1.6" y="0.6" z="1"/>',
               BLACK + LAMP.format("1 3 6"))
ENVIRONMENT = """<emitter type="envmap"><string name="filename" value="sky.exr"/>
    <transform name="to_world"><rotate x="1" angle="90"/><rotate z="1" angle="50"/></transform>
    </emitter>"""
SUNSKY = """<emitter type="sunsky"><vector name="sun_direction" value="0.5, -0.4, 0.6"/>
    <float name="turbidity" value="4.5"/><rgb name="albedo" value="0.1 0.3 0.5"/>
    <float name="sun_aperture" value="40"/><float name="sky_scale" value="3"/></emitter>"""
GROUP = ('<shape type="shapegroup" id="group">'
         + shape("obj", "", '<string name="filename" value="round.obj"/>'
                 + TWO_SIDED.format(GREY.format("0.3 0.6 0.8")))
         + shape("rectangle", '<scale value="0.7"/><translate z="-0.4"/>',
                 TWO_SIDED.format(GREY.format("0.8 0.4 0.4"))) + "</shape>")


def instance(transform):
    return shape("instance", transform, '<ref id="group"/>')


UV = ('<transform name="to_uv"><rotate z="1" angle="30"/><scale x="1.7" y="2.6"/>'
      '<translate x="0.3" y="0.1"/></transform>')

SCENES = {
    "environment, lamp and sphere lamp": floor() + ENVIRONMENT + lamp(WIDE, "2 1 0.5") + SPHERE,
    "two unequal lamps and a sphere lamp": floor() + lamp(WIDE, "2 1 0.5")
        + lamp(SMALL, "2 9 4") + SPHERE,
    "mirrored lamp and environment": floor() + ENVIRONMENT + lamp(MIRRORED, "3 5 2"),
    "textured lamp": floor() + shape(
        "rectangle", f'<rotate x="1" angle="180"/>{WIDE}',
        BLACK + '<emitter type="area">' + BITMAP.format("radiance", "") + "</emitter>"),
    "textured mirrored lamp beside a plain one": floor() + lamp(SMALL, "2 9 4") + shape(
        "rectangle", f'<rotate x="1" angle="180"/>{MIRRORED}',
        BLACK + '<emitter type="area">' + BITMAP.format("radiance", "") + "</emitter>"),
    "instances, stretched and mirrored, under a lamp": floor() + GROUP + lamp(WIDE, "6 4 3")
        + instance('<scale x="0.5" y="0.9" z="1.1"/><rotate x="0.6" y="0.8" angle="30"/>'
                   '<translate x="0.8" y="0.5" z="0.5"/>')
        + instance('<scale x="-0.8" y="0.5" z="0.9"/><rotate z="1" angle="40"/>'
                   '<translate x="-0.8" y="-0.7" z="0.4"/>'),
    "sun, sky and a pyramid": floor() + SUNSKY + shape(
        "obj", '<scale x="1.2" y="0.7" z="1.4"/><translate z="0.01"/>',
        '<string name="filename" value="round.obj"/><boolean name="face_normals" value="true"/>'
        + TWO_SIDED.format(GREY.format("0.8 0.7 0.6"))),
    "sun, sky and two lamps": floor() + SUNSKY + lamp(WIDE, "2 1 0.5") + lamp(SMALL, "2 9 4"),
    "glass and a lamp": floor() + lamp(WIDE, "4 3 2") + shape(
        "sphere", '<scale value="0.6"/><translate x="0.6" y="-0.3" z="0.7"/>',
        '<bsdf type="dielectric"><float name="int_ior" value="1.5"/>'
        '<float name="ext_ior" value="1"/></bsdf>'),
    "smooth normals under an environment and a lamp": floor() + ENVIRONMENT + lamp(WIDE, "3 2 1")
        + shape("obj", '<scale x="1.2" y="0.7" z="1.4"/><rotate z="1" angle="20"/>'
                '<translate z="0.01"/>', '<string name="filename" value="round.obj"/>'
                + TWO_SIDED.format(GREY.format("0.8 0.7 0.6"))),
    "texture with a transform and a lamp": floor(TWO_SIDED.format(
        '<bsdf type="diffuse">' + BITMAP.format("reflectance", UV) + "</bsdf>"))
        + lamp(WIDE, "4 3 2"),
}


def write_scene(folder, inside):
    mi.Bitmap(np.array([[(0.3 + 0.5 * (x % 5), 0.5 + 0.1 * x, 1.5 - 0.1 * (x % 7))
                         for x in range(16)] for _ in range(8)],
                       dtype=np.float32)).write(str(folder / "sky.exr"))
    mi.Bitmap(np.array([[(0.9 * x / 7, 0.8 - 0.1 * y, 0.1 + 0.8 * ((x + 2 * y) % 3 == 0))
                         for x in range(8)] for y in range(6)],
                       dtype=np.float32)).write(str(folder / "picture.exr"))
    (folder / "round.obj").write_text(ROUND)
    path = folder / "scene.xml"
    path.write_text(f"""<scene version="3.0.0">
        <integrator type="path"><integer name="max_depth" value="{DEPTH}"/>
        <integer name="rr_depth" value="1000"/></integrator>
        <sensor type="perspective"><float name="fov" value="50"/><transform name="to_world">
        <lookat origin="0.5,-4,3.2" target="0,0,0.4" up="0,0,1"/></transform>
        <film type="hdrfilm"><integer name="width" value="{SIDE}"/>
        <integer name="height" value="{SIDE}"/><rfilter type="box"/></film>
        <sampler type="independent"/></sensor>
        {inside}</scene>""")
    return path


def their_images(path):
    scene = mi.load_file(str(path))
    return np.array([np.array(mi.render(scene, spp=SPP, seed=seed))[:, :, :3]
                     for seed in range(SEEDS)])


def our_images(path, folder, nee):
    images = []
    for seed in range(SEEDS):
        image = folder / "image.exr"
        subprocess.run([PROGRAM, "--scene", path, "--device", "cpu", "--mode", "megakernel",
                        "--max-depth", str(DEPTH), "--rr", "0", "--spp", str(SPP), "--seed",
                        str(seed + 1), "--nee", nee, "-q", "-o", image],
                       check=True, stderr=subprocess.DEVNULL)
        images.append(np.array(mi.Bitmap(str(image)))[:, :, :3])
    return np.array(images)


@unittest.skipIf(mi is None, "the Python package mitsuba is not installed")
@unittest.skipUnless(Path(PROGRAM).exists(), f"{PROGRAM} is not built")
class Pairs(unittest.TestCase):
    def check(self, ours, theirs):
        ours_mean, theirs_mean = ours.mean(axis=(1, 2)), theirs.mean(axis=(1, 2))
        for c in range(3):
            a, b = ours_mean[:, c], theirs_mean[:, c]
            error = math.sqrt((a.var(ddof=1) + b.var(ddof=1)) / SEEDS)
            # 14 degrees of freedom: 5.4 standard errors come once in 10,000. 1e-3: edges and
            # rounding of both programs.
            self.assertLess(abs(a.mean() - b.mean()), 5.4 * error + 1e-3 * b.mean(),
                            f"channel {c}: {a.mean()} and {b.mean()}, error {error}")
            self.assertLess(error, NOISE * b.mean(), "too noisy to tell")
        # Light that is only moved about leaves the means: each pixel by its own noise. With so few
        # seeds z has a t distribution, whose standard deviation is 1.08.
        error = np.sqrt((ours.var(axis=0, ddof=1) + theirs.var(axis=0, ddof=1)) / SEEDS)
        z = (ours.mean(axis=0) - theirs.mean(axis=0)) / np.maximum(error, 1e-3 * theirs.mean())
        self.assertLess(z.std(), 1.25)
        # Caustics of glass have a few pixels whose noise is not seen in so few samples.
        self.assertLess((abs(z) > 6).sum(), 0.01 * z.size)

    def test_scenes(self):
        for name, inside in SCENES.items():
            with self.subTest(name), tempfile.TemporaryDirectory() as name_of_folder:
                folder = Path(name_of_folder)
                path = write_scene(folder, inside)
                self.check(our_images(path, folder, "on"), their_images(path))


if __name__ == "__main__":
    unittest.main()
