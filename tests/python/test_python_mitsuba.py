"""Dictionaries of Mitsuba 3: ptexp and Mitsuba render the same one to the same image, but for noise.

Skips without the package mitsuba of tests/requirements.txt.
"""
import os
import sys
import unittest
import warnings
from pathlib import Path

from ptexp_package import ROOT, TestCase, np, ptexp

sys.path.insert(0, str(ROOT / "tests" / "mitsuba"))
from mitsuba_package import mi  # noqa: E402

SIDE, SPP, SEEDS = 32, 64, 4


def look(**items):
    return {"type": "perspective", **({} if "type" in items else {"fov": 45}), "to_world": mi.ScalarTransform4f().look_at([0, 1, 4], [0, 0.4, 0], [0, 1, 0]),
            "film": {"type": "hdrfilm", "width": SIDE, "height": SIDE, "rfilter": {"type": "box"}},
            "sampler": {"type": "independent", "sample_count": SPP}, **items}


def scene(**items):
    """A sphere of the bsdf `bsdf`, or the shape `thing`, on a floor below a light from all sides."""
    bsdf = items.pop("bsdf", {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.7, 0.4, 0.2]}})
    parts = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 6},
        "sensor": look(),
        "light": {"type": "constant", "radiance": {"type": "rgb", "value": [0.6, 0.7, 0.8]}},
        "floor": {"type": "rectangle", "to_world": mi.ScalarTransform4f().rotate([1, 0, 0], -90).scale(3),
                  "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.5}}},
        "thing": {"type": "sphere", "center": [0, 0.8, 0], "radius": 0.8, "bsdf": bsdf},
        **items}
    return {name: part for name, part in parts.items() if part is not None}


def picture():
    """(8, 8, 3) floats in [0.1, 0.9], each quarter different."""
    y, x = np.mgrid[0:8, 0:8] / 8
    return np.stack([0.1 + 0.8 * x, 0.1 + 0.8 * y, 0.5 + 0.4 * (x > y)], axis=2).astype(np.float32)


def facing(**items):
    return {"type": "rectangle", "to_world": mi.ScalarTransform4f().translate([0, 0.9, 0]).scale(0.9), **items}


def textured(texture):
    return scene(thing=facing(bsdf={"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": texture}}))


def cube(**items):
    return {"type": "cube", "to_world": mi.ScalarTransform4f().translate([0, 0.8, 0]).rotate([0, 1, 0], 30).scale(0.7), **items}


def fog(medium, **items):
    return scene(integrator={"type": "volpath", "max_depth": 12}, thing=cube(bsdf={"type": "null"}, interior=medium), **items)


def grid(shape):
    values = np.linspace(0, 3, int(np.prod(shape)))
    return np.random.default_rng(1).permutation(values).reshape(shape).astype(np.float32)


def homogeneous(phase=None):
    return {"type": "homogeneous", "sigma_t": 1.5, "albedo": {"type": "rgb", "value": [0.9, 0.6, 0.3]},
            **({"phase": phase} if phase else {})}


def dim(emitter, **items):
    """Lit by one emitter, and a little from all sides."""
    return scene(**{"light": {"type": "constant", "radiance": 0.1}, "emitter": emitter, **items})


def bsdfs():
    gold = {"type": "conductor", "material": "Au"}
    red = {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.8, 0.1, 0.1]}}
    return {
        "diffuse": red, "plastic": {"type": "plastic", "diffuse_reflectance": {"type": "rgb", "value": [0.1, 0.3, 0.6]}},
        "roughplastic": {"type": "roughplastic", "alpha": 0.2}, "dielectric": {"type": "dielectric", "int_ior": "bk7"},
        "roughdielectric": {"type": "roughdielectric", "alpha": 0.3, "int_ior": 1.5}, "thindielectric": {"type": "thindielectric"},
        "conductor": gold, "roughconductor": {"type": "roughconductor", "material": "Cu", "alpha": 0.3},
        "principled": {"type": "principled", "base_color": {"type": "rgb", "value": [0.8, 0.5, 0.1]}, "metallic": 0.4, "roughness": 0.4},
        "principledthin": {"type": "principledthin", "base_color": {"type": "rgb", "value": [0.8, 0.5, 0.1]}, "diff_trans": 0.6},
        "twosided": {"type": "twosided", "bsdf": red}, "mask": {"type": "mask", "opacity": 0.4, "bsdf": red},
        "blendbsdf": {"type": "blendbsdf", "weight": 0.3, "a": red, "b": {**gold, "type": "roughconductor", "alpha": 0.4}}, "null": {"type": "null"},
        "bumpmap": {"type": "bumpmap", "arbitrary": {"type": "bitmap", "raw": True, "data": mi.TensorXf(picture())}, "scale": 0.05, "bsdf": red},
        "normalmap": {"type": "normalmap", "normalmap": {"type": "bitmap", "raw": True, "data":
                      mi.TensorXf(np.full((4, 4, 3), (0.6, 0.55, 0.9), np.float32))}, "bsdf": red},
    }


def scenes():
    """A dictionary of every plugin that ptexp reads and Mitsuba has, by a name that begins with the plugin's."""
    found = {name: scene(bsdf=bsdf) for name, bsdf in bsdfs().items()}
    def smooth():  # each its own: Mitsuba empties the tensor
        return {"type": "bitmap", "filter_type": "bilinear", "data": mi.TensorXf(picture()), "raw": True}

    found.update({
        "bitmap": textured(smooth()),
        "bitmap of a Bitmap": textured({"type": "bitmap", "bitmap": mi.Bitmap(picture()), "filter_type": "nearest", "wrap_mode": "clamp"}),
        "bitmap of bytes": textured({"type": "bitmap", "bitmap": mi.Bitmap((255 * picture()).astype(np.uint8))}),
        "bitmap of raw bytes": textured({"type": "bitmap", "bitmap": mi.Bitmap((255 * picture()).astype(np.uint8)), "raw": True}),
        "bitmap of shorts": textured({"type": "bitmap", "bitmap": mi.Bitmap((65535 * picture()).astype(np.uint16))}),
        "bitmap of grey": textured({"type": "bitmap", "data": mi.TensorXf(picture()[..., :1])}),
        "bitmap in a transform": textured({**smooth(), "to_uv": mi.ScalarTransform3f().translate([0.3, 0.1]).rotate(30).scale([2, 3])}),
        "checkerboard": textured({"type": "checkerboard", "color0": 0.1, "color1": {"type": "rgb", "value": [0.9, 0.5, 0.2]},
                                  "to_uv": mi.ScalarTransform4f().scale([4, 2, 1])}),
        "uniform": textured({"type": "uniform", "value": 0.3}), "srgb": textured({"type": "srgb", "color": [0.7, 0.3, 0.2]}),
        "rawconstant": scene(bsdf={"type": "roughconductor", "material": "Al", "alpha": {"type": "rawconstant", "value": 0.3}}),
        "d65": dim({"type": "point", "position": [1, 3, 2], "intensity": {"type": "d65", "scale": 8}}),
        "spectrum": textured({"type": "spectrum", "value": [(400, 0.1), (500, 0.6), (700, 0.2)]}),
        "area": dim({"type": "sphere", "center": [1, 2.4, 1], "radius": 0.3, "emitter": {"type": "area", "radiance": {"type": "rgb", "value": [9, 8, 5]}}}),
        "point": dim({"type": "point", "position": mi.ScalarPoint3f(1, 3, 2), "intensity": {"type": "rgb", "value": [9, 7, 5]}}),
        "spot": dim({"type": "spot", "intensity": 30.0, "cutoff_angle": 25, "to_world":
                     mi.ScalarTransform4f().look_at([1, 3, 2], [0, 0.5, 0], [0, 1, 0])}),
        "directional": dim({"type": "directional", "direction": [0.3, -1, -0.5], "irradiance": 2.0}),
        "constant": scene(light={"type": "constant", "radiance": 0.4}),
        "envmap": scene(light={"type": "envmap", "bitmap": mi.Bitmap(np.repeat(picture(), 2, axis=1)), "scale": 1.5,
                               "to_world": mi.ScalarTransform4f().rotate([0, 1, 0], 50)}),
        "projector": dim({"type": "projector", "irradiance": {"type": "bitmap", "data": mi.TensorXf(picture()), "raw": True}, "fov": 40, "scale": 4,
                          "to_world": mi.ScalarTransform4f().look_at([1, 3, 3], [0, 0.5, 0], [0, 1, 0])}),
        "sphere": scene(thing={"type": "sphere", "to_world": mi.ScalarTransform4f().translate([0, 0.9, 0]).scale(0.7)}),
        "cube": scene(thing=cube()), "rectangle": scene(thing=facing()),
        "disk": scene(thing={"type": "disk", "to_world": mi.ScalarTransform4f().translate([0, 0.9, 0]).scale(0.9)}),
        "cylinder": scene(thing={"type": "cylinder", "p0": [-0.8, 0.6, 0], "p1": [0.8, 0.6, 0], "radius": 0.5}),
        "merge": scene(thing={"type": "merge", "a": cube(), "b": facing()}),
        "instance of a shapegroup": scene(group={"type": "shapegroup", "inside": cube()}, thing={
            "type": "instance", "to_world": mi.ScalarTransform4f().rotate([0, 1, 0], 40), "group": {"type": "ref", "id": "group"}}),
        "homogeneous": fog(homogeneous()), "isotropic": fog(homogeneous({"type": "isotropic"})),
        "hg": fog(homogeneous({"type": "hg", "g": 0.7})), "rayleigh": fog(homogeneous({"type": "rayleigh"})),
        "heterogeneous with a gridvolume": fog({"type": "heterogeneous", "albedo": 0.8, "scale": 2, "sigma_t": {
            "type": "gridvolume", "data": mi.TensorXf(grid((2, 3, 4))[..., None]), "filter_type": "nearest", "to_world": box()}}),
        "gridvolume of a VolumeGrid": fog({"type": "heterogeneous", "albedo": 0.8, "sigma_t": {
            "type": "gridvolume", "grid": mi.VolumeGrid(grid((2, 3, 4))), "filter_type": "nearest", "to_world": box()}}),
        "constvolume": fog({"type": "homogeneous", "albedo": {"type": "constvolume", "value": 0.9}, "sigma_t": 2.0}),
        "orthographic": scene(sensor=look(type="orthographic", to_world=mi.ScalarTransform4f().look_at(
            [0, 1, 4], [0, 0.7, 0], [0, 1, 0]).scale([1.5, 1.5, 1]))),
        "thinlens": scene(sensor=look(type="thinlens", fov=45, aperture_radius=0.3, focus_distance=3.0)),
        "perspective": scene(sensor=look(fov_axis="y", principal_point_offset_x=0.1, near_clip=0.1)),
        "direct": scene(integrator={"type": "direct"}), "path": scene(integrator={"type": "path", "max_depth": 3, "hide_emitters": True}),
        "volpath": scene(integrator={"type": "volpath", "max_depth": 4}), "volpathmis": scene(integrator={"type": "volpathmis", "max_depth": 4}),
        "ptracer": dim({"type": "point", "position": [1, 3, 2], "intensity": 9.0}, light=None, integrator={"type": "ptracer", "max_depth": 4}),
        "ldsampler": scene(sensor=look(sampler={"type": "ldsampler", "sample_count": SPP})),
    })
    for name in ("independent", "stratified", "multijitter", "orthogonal"):
        found[name] = scene(sensor=look(sampler={"type": name, "sample_count": SPP}))
    for name in ("box", "tent", "gaussian", "mitchell", "catmullrom", "lanczos"):
        found[name] = scene(sensor=look(film={"type": "hdrfilm", "width": SIDE, "height": SIDE, "rfilter": {"type": name}}))
    return found


def box():
    """From the unit cube to that of cube()."""
    return mi.ScalarTransform4f().translate([0, 0.8, 0]).rotate([0, 1, 0], 30).scale(0.7).translate(-1).scale(2)


# Read, and tested elsewhere (tests/scene/load/mitsuba): of files, of meshes with colours, and what Mitsuba's
# RGB variants lack. Approximated: sunsky.
ELSEWHERE = {"blackbody", "regular", "irregular", "obj", "ply", "serialized", "mesh_attribute", "sunsky", "hdrfilm", "specfilm", "shapegroup", "instance", "gridvolume",
             "heterogeneous"}
# In the table for the warning alone.
NOT_READ = {"aov", "depth", "moment", "stokes", "batch", "distant", "irradiancemeter", "radiancemeter", "volume", "directionalarea",
            "timed_sunsky", "blendphase", "sggx", "tabphase", "blender", "bsplinecurve", "linearcurve", "ellipsoids",
            "ellipsoidsmesh", "sdfgrid", "circular", "hair", "measured", "measured_polarized", "polarizer", "pplastic", "retarder"}


def blocks(images):
    """Means of 8x8 pixels: (images, SIDE/8, SIDE/8, 3)."""
    images = np.asarray(images)
    n = images.shape[1] // 8
    return images.reshape(len(images), n, 8, n, 8, 3).mean(axis=(2, 4))


@unittest.skipIf(mi is None, "needs the Python package mitsuba")
class Dictionaries(TestCase):
    def assert_agrees(self, given, spp=SPP, share=0.015, **options):
        """Blocks' means by their noise, 5 standard errors, and a share of their brightness."""
        ours = ptexp.Scene.from_dict(given, **options)
        theirs = mi.load_dict(given)
        a = blocks([ours.render(spp=spp, seed=seed + 1, device="cpu").array for seed in range(SEEDS)])
        b = blocks([np.array(mi.render(theirs, spp=spp, seed=seed))[..., :3] for seed in range(SEEDS)])
        noise = np.sqrt((a.var(axis=0, ddof=1) + b.var(axis=0, ddof=1)) / SEEDS)
        a, b = a.mean(axis=0), b.mean(axis=0)
        excess = np.abs(a - b) - 5 * noise - share * np.maximum(b, 0.05)
        self.assertLess(excess.max(), 0, f"{a[np.unravel_index(excess.argmax(), a.shape)[:2]]} of ptexp, "
                        f"{b[np.unravel_index(excess.argmax(), a.shape)[:2]]} of Mitsuba; means {a.mean((0, 1))}, {b.mean((0, 1))}")

    def test_the_cornell_box_as_it_is(self):
        given = mi.cornell_box()
        image = ptexp.Scene.from_dict(given, strict=True).render(device="cpu")
        self.assertEqual((image.shape, image.stats["samples_done"]), ((256, 256, 3), 64))
        reference = np.array(mi.render(mi.load_dict(given), spp=64))[..., :3]
        np.testing.assert_allclose(image.array.mean((0, 1)), reference.mean((0, 1)), rtol=0.01)
        self.assertLess(ptexp.compare(image, reference).flip, 0.13)  # of noise
        small = [x.reshape(32, 8, 32, 8, 3).mean((1, 3)) for x in (image.array, reference)]
        self.assertLess(ptexp.compare(*small).flip, 0.03)

    def test_every_plugin(self):
        for name, given in scenes().items():
            with self.subTest(name), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                self.assert_agrees(given, share=0.03 if name in ("lanczos", "mitchell", "catmullrom") else 0.015)

    def test_every_plugin_is_known(self):
        plugins = {Path(name).stem for name in os.listdir(Path(mi.__file__).parent / "plugins")}
        kind_of = {kind: tag for tag, kinds in ptexp._ptexp.plugin_types() for kind in kinds}
        tags = {"PhaseFunction": "phase", "ReconstructionFilter": "rfilter"}
        for plugin in plugins:
            tag = mi.PluginManager.instance().plugin_type(plugin).name
            tag = tags.get(tag, tag.lower())
            self.assertIn(kind_of.get(plugin), (tag, "spectrum") if tag == "texture" else (tag,), plugin)
        tested = {name.split()[0] for name in scenes()}
        self.assertEqual(plugins - tested - ELSEWHERE - NOT_READ, set())

    def test_arrays_of_every_kind(self):
        """Of a scalar and a JIT variant, of numpy and lists: the same bits."""
        def given(vector, color, matrix, number, tensor):
            return scene(emitter={"type": "point", "position": vector([1, 3, 2]), "intensity": {"type": "rgb", "value": color([9, 7, 5])}},
                         thing={"type": "sphere", "to_world": matrix, "radius": number(0.8), "center": vector([0, 0.5, 0]),
                                "bsdf": {"type": "diffuse", "reflectance": {"type": "bitmap", "data": tensor(picture()), "raw": True}}})

        move = mi.ScalarTransform4f().translate([0, 0.25, 0]).scale([1, 1.5, 0.5])
        forms = {"lists": (list, list, np.array(move.matrix).tolist(), float, np.asarray),
                 "numpy": (np.array, np.array, np.array(move.matrix, np.float32), np.float32, np.asarray),
                 "drjit": (mi.ScalarPoint3f, mi.ScalarColor3f, move.matrix, float, mi.TensorXf),
                 "scalar": (mi.ScalarVector3f, mi.ScalarColor3f, move, mi.Float, mi.TensorXf),
                 "flat": (tuple, tuple, np.array(move.matrix).ravel(), float, np.asarray),
                 "3x4": (tuple, tuple, np.array(move.matrix)[:3], float, np.asarray)}
        made = {name: given(*form) for name, form in forms.items()}
        self.addCleanup(mi.set_variant, "scalar_rgb")
        try:
            mi.set_variant("llvm_ad_rgb")
            made["jit"] = given(mi.Point3f, mi.Color3f, mi.Transform4f(move), mi.Float, mi.TensorXf)
            np.array(made["jit"]["thing"]["radius"])
        except Exception as error:  # no LLVM here, in one of several ways
            made.pop("jit", None)
            print(f"without a JIT variant: {error}", file=sys.stderr)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            expected = ptexp.Scene.from_dict(made["lists"]).render(spp=2, device="cpu").array
            for name, one in made.items():
                with self.subTest(name):
                    self.assert_same_bits(ptexp.Scene.from_dict(one).render(spp=2, device="cpu"), expected)

    def test_what_the_two_agree_to_leave_out(self):
        with self.assertWarnsRegex(ptexp.SceneWarning, r"scene\['thing'\]: shape 'sdfgrid' is not supported"):
            ptexp.Scene.from_dict(scene(thing={"type": "sdfgrid"}))
        with self.assertRaisesRegex(ptexp.Error, r"scene\['thing'\]\['bsdf'\]: bsdf 'hair'"):
            ptexp.Scene.from_dict(scene(bsdf={"type": "hair"}), strict=True)


if __name__ == "__main__":
    unittest.main()
