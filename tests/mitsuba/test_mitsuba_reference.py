"""Compares what our loader made of Mitsuba scenes with what Mitsuba 3 itself makes of them.

Rays through the film and random rays are followed to the first surface by both: the same camera,
distance, normal, texture coordinates, reflectance and emission must come out. Skips without the
Python package `mitsuba`. PTEXP_TESTS names the test program, PTEXP_SHARED the folder with the real
scenes (otherwise `shared` beside the repository).
"""
import array
import math
import os
import random
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from mitsuba_package import mi

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("PTEXP_TESTS", str(ROOT / "build" / "dev" / "tests" / "ptexp_tests"))
SHARED = Path(os.environ.get("PTEXP_SHARED", ROOT.parent / "shared"))
DIFFUSE = 0  # MaterialKind


def load(path, **variables):
    """Mitsuba's scene. It refuses properties and names of older dialects."""
    config = mi.parser.ParserConfig("scalar_rgb")
    config.unused_properties = config.unused_parameters = mi.LogLevel.Debug
    config.merge_meshes = False
    text = path.read_text()
    for old, new in [("trilinear", "bilinear"), ("sobol", "independent"), ("ldrfilm", "hdrfilm"),
                     ("roughdiffuse", "diffuse"), ('"png"', '"openexr"')]:
        text = text.replace(old, new)
    text = re.sub(r'name="filename" value="', lambda match: match.group() + f"{path.parent}/", text)
    state = mi.parser.parse_string(config, text, **variables)
    mi.parser.transform_all(config, state)
    scene = mi.parser.instantiate(config, state)
    return scene[0] if isinstance(scene, list) else scene


def close(a, b, tolerance):
    return all(abs(x - y) <= tolerance * max(1.0, abs(y)) for x, y in zip(a, b))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def our_probes(scene, rays, folder):
    """What MitsubaProbe in test_mitsuba_probe.cpp prints for each ray, as lists of words."""
    rays_file, out = Path(folder) / "rays.txt", Path(folder) / "probes.txt"
    rays_file.write_text("\n".join(rays) + "\n")
    environment = dict(os.environ, PTEXP_PROBE_SCENE=str(scene), PTEXP_PROBE_RAYS=str(rays_file),
                       PTEXP_PROBE_OUT=str(out))
    subprocess.run([PROGRAM, "--gtest_filter=MitsubaProbe.*"], env=environment, check=True,
                   stdout=subprocess.DEVNULL, timeout=120)
    return [line.split() for line in out.read_text().splitlines()]


def film_points(count):
    """Off the diagonals, where symmetric scenes have their edges."""
    steps = range(count)
    return [((x + 0.37) / count, (y + 0.61) / count) for y in steps for x in steps]


def random_rays(scene, count):
    """From anywhere to points near the middle of some shape."""
    generator = random.Random(7)

    def point(box, low, high):
        return [a + (b - a) * generator.uniform(low, high) for a, b in zip(box.min, box.max)]

    boxes = [shape.bbox() for shape in scene.shapes()]
    for _ in range(count):
        origin = point(scene.bbox(), -0.2, 1.2)
        target = point(generator.choice(boxes), 0.2, 0.8)
        direction = [b - a for a, b in zip(origin, target)]
        length = math.sqrt(dot(direction, direction))
        yield "ray " + " ".join(f"{v:.9g}" for v in [*origin, *(d / length for d in direction)])


class Comparison:
    """Counts and explains what differs between a probe of ours and Mitsuba's."""

    def __init__(self, scene, check_sky):
        self.scene, self.check_sky = scene, check_sky
        self.differences = []
        self.hits = self.uvs = self.albedos = self.emitters = 0

    def compare(self, words):
        numbers = [float(w) for w in words[:6]]
        origin, direction = numbers[:3], numbers[3:]
        si = self.scene.ray_intersect(mi.Ray3f(origin, direction))
        problem = self.problem(words[6:], si, direction)
        if problem:
            self.differences.append(f"{problem}: from {origin} along {direction}")

    def problem(self, words, si, direction):
        if (words[0] == "hit") != bool(si.is_valid()):
            return f"{words[0]}, Mitsuba's t is {si.t}"
        numbers = [float(w) for w in words[1:]]
        if words[0] == "miss":
            return self.sky_problem(numbers, direction)
        self.hits += 1
        t, side, shading, kind = numbers[0], numbers[1:4], numbers[4:7], int(numbers[7])
        albedo, emission, uv = numbers[8:11], numbers[11:14], numbers[14:]
        normal = list(si.sh_frame.n)
        if abs(t - si.t) > 2e-4 * max(1.0, si.t):
            return f"t is {t}, Mitsuba's {si.t}"
        if dot(shading, normal) < 0.9995:
            return f"the normal is {shading}, Mitsuba's {normal}"
        if dot(side, normal) <= 0:
            return f"the side is {side}, Mitsuba's {normal}"
        if uv and si.shape.is_mesh() and not close(uv, list(si.uv), 2e-3):
            return f"uv is {uv}, Mitsuba's {si.uv}"
        self.uvs += bool(uv)
        return self.material_problem(si, kind, albedo, emission, shading, direction)

    def material_problem(self, si, kind, albedo, emission, normal, direction):
        # The normal by vertex: in Mitsuba it decides which side is seen.
        is_front = dot(normal, direction) < 0
        bsdf = si.bsdf()
        if kind == DIFFUSE and "SmoothDiffuse" in str(bsdf) and "Plastic" not in str(bsdf):
            theirs = list(bsdf.eval_diffuse_reflectance(si))
            self.albedos += 1
            if (is_front or "TwoSided" in str(bsdf)) and not close(albedo, theirs, 0.03):
                return f"the albedo is {albedo}, Mitsuba's {theirs}"
        emitter = si.emitter(self.scene)
        theirs = list(emitter.eval(si)) if emitter else [0, 0, 0]
        self.emitters += emitter is not None
        ours = emission if is_front else [0, 0, 0]
        if not close(ours, theirs, 1e-3):
            return f"the emission is {ours}, Mitsuba's {theirs}"
        return None

    def sky_problem(self, ours, direction):
        environment = self.scene.environment()
        if not environment or not self.check_sky:
            return None
        si = mi.SurfaceInteraction3f()
        si.wi = [-x for x in direction]
        theirs = list(environment.eval(si))
        return None if close(ours, theirs, 0.03) else f"the sky is {ours}, Mitsuba's {theirs}"


@unittest.skipUnless(mi, "the Python package mitsuba is not installed")
@unittest.skipUnless(Path(PROGRAM).exists(), f"{PROGRAM} is not built")
class MitsubaReference(unittest.TestCase):
    def compare(self, path, film=14, rays=250, allowed=0.005, check_sky=True, **variables):
        """`allowed` is the share of rays that may differ: those along edges."""
        scene = load(path, **variables)
        points = film_points(film)
        lines = [f"film {x:.9g} {y:.9g}" for x, y in points] + list(random_rays(scene, rays))
        with tempfile.TemporaryDirectory() as folder:
            probes = our_probes(path, lines, folder)
        self.assertEqual(len(probes), len(lines))
        sensor = scene.sensors()[0]
        for (x, y), words in zip(points, probes):
            ray, _ = sensor.sample_ray(0, 0.5, (x, y), (0.5, 0.5))
            direction = [float(w) for w in words[3:6]]
            self.assertGreater(dot(direction, list(ray.d)), 1 - 1e-6, f"film {x} {y}")
        comparison = Comparison(scene, check_sky)
        for words in probes:
            comparison.compare(words)
        self.assertLessEqual(len(comparison.differences), allowed * len(probes),
                             "\n".join(comparison.differences[:20]))
        self.assertGreater(comparison.hits, 0)
        return comparison

    def shared(self, name):
        path = SHARED / "scenes" / name / "scene.xml"
        if not path.exists():
            self.skipTest(f"{path} is not there")
        return path

    def test_cornell_box(self):
        comparison = self.compare(self.shared("cornell-box"))
        self.assertGreater(comparison.albedos, 100)

    def test_modern_hall(self):
        self.assertGreater(self.compare(self.shared("modern-hall")).uvs, 100)

    def test_grey_white_room(self):
        # The sky has a sun: half a texel, by which Mitsuba's rows differ from ours, is much there.
        self.compare(self.shared("grey-white-room"), method="path", check_sky=False)

    def test_all_shapes(self):
        with tempfile.TemporaryDirectory() as folder:
            comparison = self.compare(write_zoo(Path(folder)), film=25, rays=1000)
        self.assertGreater(comparison.uvs, 100)
        self.assertGreater(comparison.emitters, 30)
        self.assertGreater(comparison.albedos, 300)


def write_picture(path, width, height, pixel):
    values = array.array("f")
    for y in reversed(range(height)):
        for x in range(width):
            values.extend(pixel((x + 0.5) / width, (y + 0.5) / height))
    path.write_bytes(f"PF\n{width} {height}\n-1.0\n".encode() + values.tobytes())
    bitmap = mi.Bitmap(str(path))
    bitmap.write(str(path.with_suffix(".exr")))
    eight = bitmap.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.UInt8, True)
    eight.write(str(path.with_suffix(".png")))


TETRAHEDRON = """v 0 0 0
v 1 0 0
v 0 2 0
v 0 0 1.5
vt 0 0
vt 1 0
vt 0 1
f 1/1 3/3 2/2
f 1/1 2/2 4/3
f 1/1 4/3 3/2
f 2/1 3/2 4/3
"""

SQUARE = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
property float u
property float v
element face 2
property list uchar int vertex_indices
end_header
-1 -1 0 0 0
1 -1 0 1 0
1 1 0.5 1 1
-1 1 0 0 1
3 0 1 2
3 0 2 3
"""

BITMAP = """<bsdf type="diffuse"><texture type="bitmap" name="reflectance">
<string name="filename" value="picture.png"/>{}</texture></bsdf>"""
LIGHT = '<emitter type="area"><rgb name="radiance" value="{}"/></emitter>'


def shape(kind, transform, inside=""):
    return (f'<shape type="{kind}">{inside}<transform name="to_world">{transform}</transform>'
            "</shape>\n")


def write_zoo(folder):
    """A scene with every shape, turned, mirrored, flipped, textured, emitting and repeated."""
    write_picture(folder / "picture.pfm", 32, 16, lambda u, v: (
        0.5 + 0.4 * math.sin(6 * u), 0.5 + 0.4 * math.cos(5 * v), 0.2 + 0.6 * u * v))
    write_picture(folder / "sky.pfm", 128, 256, lambda u, v: (
        1 + 0.5 * math.cos(2 * math.pi * u), 1 + 0.5 * math.sin(2 * math.pi * u), v))
    (folder / "tetrahedron.obj").write_text(TETRAHEDRON)
    (folder / "square.ply").write_text(SQUARE)
    # Mitsuba 3.9.1 does not rotate about an axis that has not unit length: it scales as well.
    turn = '<rotate x="0.48" y="0.6" z="0.64" angle="40"/>'
    flip = '<boolean name="flip_normals" value="true"/>'
    flat = '<boolean name="face_normals" value="true"/>'
    obj = '<string name="filename" value="tetrahedron.obj"/>'
    ply = obj.replace("tetrahedron.obj", "square.ply")
    clamp = '<string name="wrap_mode" value="clamp"/>'
    mirror = '<scale x="-1"/>'
    uv = '<transform name="to_uv"><scale x="2" y="3"/><translate x="0.25" y="0.1"/></transform>'
    checker = ('<bsdf type="diffuse"><texture type="checkerboard" name="reflectance">'
               f"{uv}</texture></bsdf>")
    kinds = [("rectangle", ""), ("cube", ""), ("sphere", ""), ("disk", ""), ("cylinder", ""),
             ("obj", obj), ("obj", obj + flat), ("ply", ply)]
    variants = [("", LIGHT.format("1 2 3")), ("", flip + LIGHT.format("2")),
                (mirror, LIGHT.format("3 1 1")), (mirror, flip + LIGHT.format("1 5 1")),
                ("", BITMAP.format("")), (mirror, BITMAP.format(uv + clamp)), ("", checker)]
    xml = '<scene version="3.0.0"><integrator type="path"/>\n'
    xml += """<sensor type="perspective"><float name="fov" value="44"/>
        <string name="fov_axis" value="smaller"/><transform name="to_world">
        <lookat origin="9,14,-33" target="9,11,0" up="0.2,1,0"/></transform>
        <film type="hdrfilm"><integer name="width" value="300"/>
        <integer name="height" value="200"/></film></sensor>\n"""
    for row, (kind, inside) in enumerate(kinds):
        for column, (step, extra) in enumerate(variants):
            place = f'<translate x="{3 * column}" y="{3 * row}"/>'
            # Mitsuba's spheres and cylinders must stay round.
            squeezed = kind not in ("sphere", "cylinder")
            grow = f'<scale value="{"0.7, 1, 1.2" if squeezed else "0.9"}"/>'
            xml += shape(kind, grow + step + turn + place, inside + extra)
    xml += '<shape type="shapegroup" id="group">'
    xml += shape("obj", turn, obj) + shape("rectangle", '<translate z="-1"/>', "")
    xml += shape("sphere", '<scale value="0.4"/><translate y="1"/>', "") + "</shape>\n"
    for i in range(4):
        step = mirror if i % 2 else ""
        xml += shape("instance", f'<scale value="1, 0.8, 1.1"/>{step}{turn}'
                     f'<translate x="{4 * i + 1}" y="25"/>', '<ref id="group"/>')
    xml += shape("cylinder", turn + '<translate x="-4" y="4"/>',
                 '<point name="p0" value="0,1,0"/><point name="p1" value="1,-2,0.5"/>'
                 '<float name="radius" value="0.6"/>' + BITMAP.format(""))
    xml += shape("sphere", turn + '<scale value="1.5"/><translate x="-4" y="9"/>',
                 '<point name="center" value="0.1,0.2,0.3"/><float name="radius" value="0.7"/>')
    xml += """<emitter type="envmap"><string name="filename" value="sky.exr"/>
        <float name="scale" value="0.5"/><transform name="to_world">
        <rotate y="1" angle="70"/><rotate x="1" angle="25"/></transform></emitter></scene>"""
    path = folder / "scene.xml"
    path.write_text(xml)
    return path


if __name__ == "__main__":
    unittest.main()
