"""Compares light with Mitsuba 3: environment maps of few rows, a lamp inside of glass, a room far
from the origin.

Skips without the Python package `mitsuba`. PTEXP names the program, PTEXP_SHARED the folder of
scenes.
"""
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

from mitsuba_package import mi, np

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("PTEXP", str(ROOT / "build" / "dev" / "src" / "ptexp"))
SHARED = Path(os.environ.get("PTEXP_SHARED", ROOT.parent / "shared"))

HEAD = """<scene version="3.0.0">
<integrator type="path"><integer name="max_depth" value="{depth}"/>
  <integer name="rr_depth" value="1000"/></integrator>
<sensor type="perspective"><float name="fov" value="{fov}"/>
  <transform name="to_world"><lookat origin="{origin}" target="{target}" up="{up}"/></transform>
  <sampler type="independent"/>
  <film type="hdrfilm"><integer name="width" value="{size}"/><integer name="height" value="{size}"/>
    <rfilter type="box"/></film></sensor>
"""

LAMP_IN_GLASS = """
<shape type="rectangle">
  <transform name="to_world"><rotate x="1" angle="-90"/><scale value="6"/></transform>
  <bsdf type="diffuse"><rgb name="reflectance" value="0.6, 0.55, 0.5"/></bsdf></shape>
<shape type="sphere"><point name="center" x="0" y="1.3" z="0"/>
  <bsdf type="dielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf>
</shape>
<shape type="sphere"><point name="center" x="0" y="1.3" z="0"/><float name="radius" value="0.6"/>
  <bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf>
  <emitter type="area"><rgb name="radiance" value="3"/></emitter></shape>
"""


def our_image(path, spp, seed=1, *options):
    image = path.parent / "image.exr"
    subprocess.run([PROGRAM, "--scene", path, "--device", "cpu", "--mode", "megakernel", "--spp",
                    str(spp), "--seed", str(seed), "-q", "-o", image, *options], check=True,
                   stderr=subprocess.DEVNULL)
    return np.array(mi.Bitmap(str(image)))[:, :, :3]


def mean_and_error(images):
    """Of independent images: mean of all pixels and its standard error."""
    means = np.array([image.mean() for image in images])
    return means.mean(), means.std(ddof=1) / np.sqrt(len(means))


class Scenes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def write(self, inside, **head):
        path = self.folder / "scene.xml"
        path.write_text(HEAD.format(**head) + inside + "</scene>\n")
        return path

    def assert_close(self, ours, theirs, tolerance):
        """Two (mean, standard error): within the tolerance beyond four standard errors."""
        (a, error_a), (b, error_b) = ours, theirs
        self.assertLess(np.hypot(error_a, error_b), 0.005 * b, "too noisy to tell anything")
        self.assertLess(abs(a - b), tolerance * b + 4 * np.hypot(error_a, error_b),
                        f"{ours} and {theirs}")


@unittest.skipIf(mi is None, "needs the Python package mitsuba")
class Lamps(Scenes):
    def test_a_lamp_inside_of_glass(self):
        path = self.write(LAMP_IN_GLASS, depth=8, fov=40, origin="0, 2.5, 7", target="0, 0.8, 0",
                          up="0, 1, 0", size=40)
        scene = mi.load_file(str(path))
        theirs = [np.array(mi.render(scene, spp=64, seed=seed)) for seed in range(10)]
        ours = [our_image(path, 64, seed) for seed in range(1, 11)]
        for part in (slice(0, 18), slice(18, 40)):  # the ball, the floor that it lights
            self.assert_close(mean_and_error([image[part] for image in ours]),
                              mean_and_error([image[part] for image in theirs]), 0.002)

    def test_a_room_far_from_the_origin(self):
        path = SHARED / "mitsuba" / "15d_box_far.xml"
        if not path.exists():
            self.skipTest(f"{path} is not there")
        copy = self.folder / "scene.xml"
        copy.write_text(path.read_text().replace("assets/", str(path.parent / "assets") + "/"))
        size = ("--width", "60", "--height", "60")
        ways = [mean_and_error([our_image(copy, 64, seed, "--nee", nee, *size)
                                for seed in range(1, 9)]) for nee in ("on", "off")]
        self.assertLess(abs(ways[0][0] - ways[1][0]),
                        0.002 * ways[1][0] + 4 * np.hypot(ways[0][1], ways[1][1]), ways)


def strong_poles(width, height):
    """Rows of very different brightness, the poles the brightest; different around, too."""
    rows = np.linspace(0, 1, height)[:, None]
    columns = np.linspace(0, 1, width, endpoint=False)[None, :]
    grey = 1 + 0.5 * np.sin(2 * np.pi * columns) + rows
    grey = grey + 40 * (rows == 0) + 25 * (rows == 1)
    return np.stack([grey, grey * (1 + rows), grey * 0.5], axis=2).astype(np.float32)


@unittest.skipIf(mi is None, "needs the Python package mitsuba")
class EnvironmentMaps(Scenes):
    def write_map(self, width, height):
        name = self.folder / "map.exr"
        mi.Bitmap(strong_poles(width, height)).write(str(name))
        return (f'<emitter type="envmap"><string name="filename" value="{name}"/>'
                '<transform name="to_world"><rotate x="1" angle="25"/></transform></emitter>')

    def test_what_the_camera_sees(self):
        ball = '<shape type="sphere"><point name="center" x="0" y="0" z="90"/></shape>'
        for width, height in ((128, 64), (16, 8)):
            for target, up in (("0.1, 1, -0.4", "0, 0, 1"), ("0, -1, 0.3", "0, 0, 1"),
                               ("1, 0.1, 0", "0, 1, 0")):
                path = self.write(ball + self.write_map(width, height), depth=2, fov=70,
                                  origin="0, 0, 0", target=target, up=up, size=64)
                theirs = np.array(mi.render(mi.load_file(str(path)), spp=64))
                ours = our_image(path, 64)
                for channel in range(3):
                    a, b = ours[..., channel].mean(), theirs[..., channel].mean()
                    self.assertLess(abs(a - b), 0.001 * b, f"{width}x{height} to {target}: {a} {b}")

    def irradiance(self, emitter, up, rows):
        """By the midpoint rule over Mitsuba's own lookup."""
        theta = (np.arange(rows) + 0.5) * np.pi / rows
        phi = (np.arange(2 * rows) + 0.5) * np.pi / rows
        interaction = mi.SurfaceInteraction3f()
        total = np.zeros(3)
        for t in theta:
            for p in phi:
                w = np.array([np.sin(t) * np.cos(p), np.cos(t), np.sin(t) * np.sin(p)])
                cosine = w @ up
                if cosine > 0:
                    interaction.wi = mi.Vector3f(*(-w))
                    total += np.array(emitter.eval(interaction)) * cosine * np.sin(t)
        return total * (np.pi / rows) ** 2

    def test_what_a_floor_receives(self):
        floor = ('<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/>'
                 '</transform><bsdf type="diffuse"><rgb name="reflectance" value="1"/></bsdf></shape>')
        path = self.write(floor + self.write_map(32, 16), depth=2, fov=20, origin="0, 2, 0",
                          target="0, 0, 0", up="0, 0, 1", size=32)
        emitter = mi.load_file(str(path)).emitters()[0]
        expected = self.irradiance(emitter, np.array([0.0, 1.0, 0.0]), 200).mean() / np.pi
        for nee in ("on", "off"):
            ours = mean_and_error([our_image(path, 256, seed, "--nee", nee)
                                   for seed in range(1, 9)])
            self.assert_close(ours, (expected, 0), 0.001)


if __name__ == "__main__":
    unittest.main()
