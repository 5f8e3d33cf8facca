"""Compares images with those of Mitsuba 3 at the same depth.

The scenes are those of the folder `shared/scenes` with their own materials, but for the few BSDFs
that Mitsuba 3 lacks, which are diffuse for both: then all that differs is noise. Skips without the Python
package `mitsuba` or without the scenes. PTEXP names the program, PTEXP_SHARED the folder.
"""
import os
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as ET
from pathlib import Path

from mitsuba_package import mi, np

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("PTEXP", str(ROOT / "build" / "dev" / "src" / "ptexp"))
SHARED = Path(os.environ.get("PTEXP_SHARED", ROOT.parent / "shared"))
DEPTH = 6
LACKING = {"roughdiffuse", "phong", "ward"}  # in Mitsuba 3.9
# Lies in one plane with another floor, so that either may be the one that a ray meets.
AMBIGUOUS = {"FloorTiles"}
REFLECTANCES = {"reflectance", "diffuse_reflectance", "diffuseReflectance", "base_color"}


def as_diffuse(bsdf):
    """Turns an element into a diffuse BSDF of its own reflectance."""
    bsdf.set("type", "diffuse")
    for child in list(bsdf):
        if child.get("name") in REFLECTANCES:
            child.set("name", "reflectance")
        else:
            bsdf.remove(child)


def simplify(element):
    """Leaves nothing that only one of the two renderers has."""
    for child in list(element):
        if child.tag == "bsdf" and child.get("type") in LACKING:
            as_diffuse(child)
        if child.get("id") in AMBIGUOUS or child.tag == "medium" or (child.tag == "ref" and child.get("name") in
                                     ("interior", "exterior")):
            element.remove(child)
            continue
        simplify(child)


def prepare(source, folder, width, height):
    """A copy of a scene with a small film."""
    tree = ET.parse(source)
    scene = tree.getroot()
    for default in scene.findall("default"):
        if default.get("name") in ("method", "integrator"):
            default.set("value", "path")
    simplify(scene)
    integrator = scene.find("integrator")
    for child in list(integrator):
        integrator.remove(child)
    integrator.set("type", "path")
    ET.SubElement(integrator, "integer", name="maxDepth" if scene.get("version")[0] == "0" else
                  "max_depth", value=str(DEPTH))
    film = scene.find("sensor").find("film")
    for child in list(film):
        film.remove(child)
    film.set("type", "hdrfilm")
    ET.SubElement(film, "integer", name="width", value=str(width))
    ET.SubElement(film, "integer", name="height", value=str(height))
    ET.SubElement(film, "rfilter", type="box")
    sampler = scene.find("sensor").find("sampler")
    sampler.set("type", "independent")
    for texture in scene.iter("texture"):
        for child in texture.findall("string"):
            if child.get("value") == "trilinear":
                child.set("value", "bilinear")
    for string in scene.iter("string"):
        if string.get("name") == "filename":
            string.set("value", str(source.parent / string.get("value")))
    path = folder / "scene.xml"
    tree.write(path)
    return path


def mitsuba_images(path, spp, count):
    config = mi.parser.ParserConfig("scalar_rgb")
    config.unused_properties = config.unused_parameters = mi.LogLevel.Debug
    state = mi.parser.parse_file(config, str(path))
    mi.parser.transform_all(config, state)
    scene = mi.parser.instantiate(config, state)
    scene = scene[0] if isinstance(scene, list) else scene
    integrator = mi.load_dict({"type": "path", "max_depth": DEPTH, "rr_depth": 1000})
    return np.array([np.array(mi.render(scene, integrator=integrator, spp=spp, seed=seed))[:, :, :3]
                     for seed in range(count)])


def our_images(path, folder, spp, count):
    images = []
    for seed in range(count):
        image = Path(folder) / "image.exr"
        subprocess.run([PROGRAM, "--scene", path, "--device", "cpu", "--mode", "megakernel",
                        "--max-depth", str(DEPTH), "--rr", "0", "--spp", str(spp), "--seed",
                        str(seed + 1), "-q", "-o", image], check=True, stderr=subprocess.DEVNULL)
        images.append(np.array(mi.Bitmap(str(image)))[:, :, :3])
    return np.array(images)


@unittest.skipIf(mi is None, "needs the Python package mitsuba")
class Images(unittest.TestCase):
    def compare(self, name, width, height, spp, count=6):
        source = SHARED / "scenes" / name / "scene.xml"
        if not source.exists():
            self.skipTest(f"{source} is not there")
        with tempfile.TemporaryDirectory() as folder:
            path = prepare(source, Path(folder), width, height)
            theirs = mitsuba_images(path, spp, count)
            ours = our_images(path, folder, spp, count)
        return ours, theirs

    def assert_means(self, ours, theirs):
        """By the noise of the means themselves: 5.5 of their standard errors and 2e-3, for edges
        that lie differently in both."""
        count = len(ours)
        for channel in range(3):
            a = ours[..., channel].mean(axis=(1, 2))
            b = theirs[..., channel].mean(axis=(1, 2))
            error = np.sqrt((a.var(ddof=1) + b.var(ddof=1)) / count)
            self.assertLess(abs(a.mean() - b.mean()), 5.5 * error + 2e-3 * b.mean(),
                            f"channel {channel}: {a.mean()} and {b.mean()}, error {error}")

    def test_cornell_box_pixel_by_pixel(self):
        ours, theirs = self.compare("cornell-box", 40, 40, 64, 12)
        error = np.sqrt((ours.var(axis=0, ddof=1) + theirs.var(axis=0, ddof=1)) / len(ours))
        z = (ours.mean(axis=0) - theirs.mean(axis=0)) / np.maximum(error, 1e-6)
        # With 22 degrees of freedom z is t-distributed: variance 1.1, and 5.5 comes once in 65,000.
        self.assertLess(abs(z.mean()), 0.15)
        self.assertLess(z.std(), 1.25)
        self.assertLess((abs(z) > 5.5).sum(), 4)
        self.assert_means(ours, theirs)

    def test_modern_hall(self):
        ours, theirs = self.compare("modern-hall", 40, 40, 64)
        self.assert_means(ours, theirs)

    def test_grey_white_room(self):
        ours, theirs = self.compare("grey-white-room", 48, 27, 64)
        self.assert_means(ours, theirs)


if __name__ == "__main__":
    unittest.main()
