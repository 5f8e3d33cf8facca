"""Scenes that move, rendered by pbrt-v4 and by ptexp from the same files.

Means over blocks of pixels of renders of several seeds must agree within 5 standard errors. Colours
are grey: pbrt's products of spectra are not those of RGB. pbrt interpolates the motion of an
ObjectInstance in the space in which it renders, which is therefore the world here. PTEXP_PBRT names
pbrt's program; skips without it.
"""
import os
import subprocess
import unittest

from ptexp_package import TestCase, np, ptexp

PBRT = os.environ.get("PTEXP_PBRT", "")
WIDTH, HEIGHT, BLOCK = 64, 48, 8
SEEDS, SPP = 12, 64

HEAD = f"""Film "rgb" "integer xresolution" {WIDTH} "integer yresolution" {HEIGHT} PixelFilter "box"
Sampler "independent" "integer pixelsamples" {SPP} Integrator "volpath" "integer maxdepth" 4
"""
VIEW = """LookAt 0 1.5 -6  0 0 0  0 1 0
Camera "perspective" "float fov" 45 "float shutteropen" $open "float shutterclose" $close
"""
MOVING_VIEW = """ActiveTransform StartTime LookAt -.5 1.5 -6  0 0 0  0 1 0
ActiveTransform EndTime LookAt 1 1.2 -5  .3 .2 0  .1 1 0 ActiveTransform All
Camera "perspective" "float fov" 45
"""
ROOM = """WorldBegin LightSource "infinite" "rgb L" [.5 .5 .5]
AttributeBegin AreaLightSource "diffuse" "rgb L" [10 10 10] "bool twosided" true
Shape "trianglemesh" "point3 P" [-1 3 -1  1 3 -1  1 3 1  -1 3 1] "integer indices" [0 1 2 0 2 3] AttributeEnd
Material "diffuse" "rgb reflectance" [.5 .5 .5]
Shape "trianglemesh" "point3 P" [-9 -1 -9  9 -1 -9  9 -1 9  -9 -1 9] "integer indices" [0 2 1 0 3 2]
"""
TURN = "ActiveTransform StartTime Translate -1.5 0 0 ActiveTransform EndTime Translate 1.2 .5 1 Rotate 130 .2 1 .3 "
BALL = TURN + 'ActiveTransform All Shape "sphere" "float radius" .6\n'
STRETCH = TURN + "Scale 1.4 .8 1 ActiveTransform All\n"
SHEET = ('Shape "trianglemesh" "point3 P" [-.5 -.5 0 .5 -.5 0 .5 .7 0 -.5 .5 .3] "integer indices" [0 1 2 0 2 3]\n')
FOG = ('MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [.1 .1 .1] "rgb sigma_s" [1.5 1.5 1.5] '
       'MediumInterface "fog" "" Material "interface" ')


def view(opens=0, closes=1):
    return VIEW.replace("$open", str(opens)).replace("$close", str(closes))


def block_means(image):
    return np.asarray(image, float)[..., 0].reshape(HEIGHT // BLOCK, BLOCK, WIDTH // BLOCK, BLOCK).mean((1, 3))


@unittest.skipUnless(PBRT, "PTEXP_PBRT does not name pbrt's program")
class PbrtMotion(TestCase):
    def by_pbrt(self, scene, seed):
        image = self.folder / "image.exr"
        subprocess.run([PBRT, "--quiet", "--render-coord-sys", "world", "--seed", str(seed), "--outfile", image, scene],
                       check=True, capture_output=True)
        return ptexp.read_image(image)

    def check(self, text):
        path = self.write("scene.pbrt", HEAD + text)
        scene, seeds = ptexp.load(path, strict=True), range(1, SEEDS + 1)
        theirs = np.array([block_means(self.by_pbrt(path, seed)) for seed in seeds])
        ours = np.array([block_means(scene.render(spp=SPP, seed=seed)) for seed in seeds])
        error = np.sqrt((theirs.var(0, ddof=1) + ours.var(0, ddof=1)) / SEEDS)
        deviation = (theirs.mean(0) - ours.mean(0)) / np.maximum(error, 1e-7)
        self.assertLess(np.abs(deviation).max(), 5)
        self.assertLess((deviation ** 2).mean(), 1.8)  # 1.1 is expected

    def test_a_sphere(self):
        self.check(view() + ROOM + BALL)

    def test_a_mesh_that_turns_and_grows(self):
        self.check(view() + ROOM + STRETCH + SHEET)

    def test_a_short_shutter(self):
        self.check(view(0.3, 0.6) + ROOM + STRETCH + SHEET)

    def test_motion_within_the_shutter(self):
        self.check("TransformTimes .2 .8\n" + view() + ROOM + STRETCH + SHEET)

    def test_instances(self):
        self.check(view() + ROOM + 'ObjectBegin "sheet" ' + SHEET + "ObjectEnd AttributeBegin " + STRETCH +
                   'ObjectInstance "sheet" AttributeEnd Translate .5 .3 2 ' + STRETCH + 'ObjectInstance "sheet"\n')

    def test_a_camera(self):
        self.check(MOVING_VIEW + ROOM + "Translate .3 0 0 " + SHEET)

    def test_glass(self):
        self.check(view() + ROOM + 'Material "dielectric" "float eta" 1.5 ' + BALL)

    def test_fog(self):
        self.check(view() + ROOM + FOG + BALL)


if __name__ == "__main__":
    unittest.main()
