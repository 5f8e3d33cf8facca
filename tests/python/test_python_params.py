"""Parameters that are changed give the bits of a file that has the values; so do dictionaries."""
import gc
import re
import unittest
from pathlib import Path

from ptexp_package import ROOM_VALUES, TestCase, np, ptexp, room


def matrix(x, y):
    return [[1, 0, 0, x], [0, 1, 0, y], [0, 0, 1, 0], [0, 0, 0, 1]]


class Params(TestCase):
    # parameter, value, the same in the file
    CASES = [
        ("camera.fov", 60.0, {"fov": 60.0}),
        ("materials.red.albedo", (0.25, 0.1, 0.1), {"red": 0.25}),
        ("materials.lacquer.eta", 1.9, {"eta": 1.9}),
        ("lights.lamp.radiance", (9, 9, 9), {"lamp": 9}),
        ("lights.bulb.intensity", (7, 1, 1), {"bulb": 7}),
        ("instances.0.to_world", matrix(-1.5, 0.4), {"cube": -1.5}),
        ("camera.origin", (-1.0, 1, 4), {"x": -1.0}),
    ]
    STRUCTURES = [{}, {"accel": "bvh2", "builder": "sah"}, {"accel": "cwbvh", "builder": "sbvh"},
                  {"accel": "brute", "device": "cpu"}, {"mode": "megakernel"}, {"mode": "serial"}]

    def changed(self, names_and_values, **file_values):
        """(the scene that was changed, the image of a file that has the values)"""
        scene = ptexp.load(self.write("before.xml", room()))
        before = ptexp.render(scene)
        for name, value in names_and_values.items():
            scene.params[name] = value
        expected = ptexp.render(self.write("after.xml", room(**file_values)))
        self.assert_other_image(before, expected)
        return scene, expected

    def test_each(self):
        for name, value, file_values in self.CASES:
            with self.subTest(name):
                scene, expected = self.changed({name: value}, **file_values)
                self.assert_same_bits(ptexp.render(scene), expected)

    def test_all_in_turn_with_each_structure(self):
        every = {key: value for _, _, values in self.CASES for key, value in values.items()}
        path = self.write("after.xml", room(**every))
        before = self.write("before.xml", room())
        for options in self.STRUCTURES:
            with self.subTest(**options):
                scene = ptexp.load(before, **options)
                for name, value, _ in self.CASES:
                    last = ptexp.render(scene)
                    scene.params[name] = value
                    self.assert_other_image(ptexp.render(scene), last)
                self.assert_same_bits(ptexp.render(scene), ptexp.render(path, **options))

    def test_vertices_are_those_of_a_scene_made_with_them(self):
        def scene(vertices, **options):
            thing = {"type": "mesh", "vertices": vertices, "triangles": triangles, "face_normals": True}
            sensor = {"type": "perspective", "fov": 40.0, "to_world": [[-1, 0, 0, 0], [0, 1, 0, 1], [0, 0, -1, 4], [0, 0, 0, 1]]}
            parts = {"type": "scene", "sensor": sensor, "thing": thing, "sky": {"type": "constant", "radiance": 1.0}}
            return ptexp.Scene.from_dict(parts, width=32, height=24, spp=4, **options)

        random = np.random.default_rng(1)
        side = np.arange(20)
        at = np.stack(np.meshgrid(side, side), -1).reshape(-1, 2)
        first = at[(at < 19).all(1)] @ [1, 20]
        triangles = np.concatenate([np.stack([first, first + 1, first + 20], 1), np.stack([first + 20, first + 1, first + 21], 1)])
        flat = np.column_stack([at / 10 - 1, np.zeros(400)]).astype(np.float32)
        bent = flat + np.float32([0, 0, 1]) * np.sin(3 * flat[:, :1])
        for options in self.STRUCTURES:
            with self.subTest(**options):
                edited = scene(flat, **options)
                last = edited.render()
                self.assertTrue(np.array_equal(edited.params["meshes.thing.vertices"], flat))
                for vertices in (bent, random.permutation(bent), flat):  # refitted, built anew, refitted
                    edited.params["meshes.thing.vertices"] = vertices
                    self.assertTrue(np.array_equal(edited.params["meshes.thing.vertices"], vertices.astype(np.float32)))
                    image = edited.render()
                    self.assert_other_image(image, last)
                    self.assert_same_bits(image, scene(vertices, **options).render())
                    last = image
        edited.params["thing.vertex_positions"] = bent.ravel().tolist()  # as Mitsuba has them
        self.assert_same_bits(edited.render(), scene(bent, **options).render())
        for wrong, message in ((flat[1:], "399 x 3; expected 400 x 3"), (at, "400 x 2; expected 400 x 3"),
                               (np.full_like(flat, np.inf), "inf: expected finite numbers")):
            with self.assertRaisesRegex(ptexp.Error, message):
                edited.params["meshes.thing.vertices"] = wrong
        with self.assertRaises(ValueError):
            edited.params["meshes.thing.vertices"] = "none"
        self.assertIn("meshes.thing.vertices = an array of 400 x 3", repr(edited.params).splitlines())

    def test_normals_are_changed_by_themselves(self):
        vertices = np.float32([[-1, 0, 0], [1, 0, 0], [1, 2, 0], [-1, 2, 0]])
        normals = np.float32([[-0.6, 0, 0.8], [0.6, 0, 0.8], [0, 0.6, 0.8], [0, 0, 1]])

        def scene(normals):
            thing = {"type": "mesh", "vertices": vertices, "triangles": [[0, 1, 2], [0, 2, 3]], "normals": normals}
            lamp = {"type": "point", "to_world": matrix(1, 2)[:2] + [[0, 0, 1, 3], [0, 0, 0, 1]]}
            sensor = {"type": "perspective", "fov": 40.0, "to_world": [[-1, 0, 0, 0], [0, 1, 0, 1], [0, 0, -1, 4], [0, 0, 0, 1]]}
            return ptexp.Scene.from_dict({"type": "scene", "sensor": sensor, "thing": thing, "lamp": lamp}, width=32, height=24, spp=4)

        edited = scene(normals)
        before = edited.render()
        edited.params["meshes.thing.normals"] = normals[::-1]
        self.assert_other_image(edited.render(), before)
        self.assert_same_bits(edited.render(), scene(normals[::-1]).render())

    def test_an_equal_value_does_nothing(self):
        scene = ptexp.load(self.write("room.xml", room()))
        image = ptexp.render(scene)
        self.assertGreater(image.stats["time_ms"]["scene"], 0)
        for name, value in dict(scene.params).items():
            scene.params[name] = value
        again = ptexp.render(scene)
        self.assertEqual(again.stats["time_ms"]["scene"], 0)
        self.assert_same_bits(image, again)

    def test_memory_stays_over_a_thousand_edits(self):
        statm = Path("/proc/self/statm")
        if not statm.exists():
            self.skipTest("needs /proc")
        scene = ptexp.load(self.write("room.xml", room()), width=8, height=6, spp=1)
        name = next(name for name in scene.params if name.endswith(".vertices"))
        start = scene.params[name]
        edits = [(name, lambda i: start + i / 1e4), ("materials.red.albedo", lambda i: i / 1000),
                 ("lights.lamp.radiance", lambda i: i % 7), ("instances.0.to_world", lambda i: matrix(i / 1000, 0.4)),
                 ("camera.fov", lambda i: 30 + i / 100), ("materials.red.opacity", lambda i: 1 - i % 2 / 2)]

        def edit(first, count):
            for i in range(first, first + count):
                key, value = edits[i % len(edits)]
                scene.params[key] = value(i)
                ptexp.render(scene)
            gc.collect()
            return int(statm.read_text().split()[1]) * 4096

        warm = edit(0, 300)
        self.assertLess(edit(300, 1000) - warm, 8 << 20)

    def test_spheres(self):
        def scene(center, radius):
            ball = {"type": "sphere", "center": center, "radius": radius, "bsdf": {"type": "diffuse", "id": "paint"}}
            return ptexp.Scene.from_dict({"type": "scene", "sensor": {"type": "perspective", "to_world": {
                "type": "lookat", "origin": (0, 0, 5), "target": (0, 0, 0)}}, "ball": ball, "box": {"type": "cube"},
                "sky": {"type": "constant"}}, width=24, height=18, spp=2)

        changed = scene((0, 0, 2), 0.5)
        params = changed.params
        self.assertEqual((params["spheres.paint.center"], params["paint.radius"]), ((0, 0, 2), 0.5))
        before = ptexp.render(changed)
        params["paint.center"], params["paint.radius"] = (0.5, 0.25, 2), 0.25
        self.assert_other_image(ptexp.render(changed), before)
        self.assert_same_bits(ptexp.render(changed), ptexp.render(scene((0.5, 0.25, 2), 0.25)))
        with self.assertRaisesRegex(ptexp.Error, "spheres.paint.radius: expected a number above 0"):
            params["paint.radius"] = 0

    def test_two_numbers_of_a_material(self):
        values = {"materials.metal.alpha_x": 0.5, "materials.metal.alpha_y": 0.5}
        scene, expected = self.changed(values, alpha=0.5)
        self.assert_same_bits(ptexp.render(scene), expected)

    def test_what_is_precomputed_follows(self):
        scene, expected = self.changed({"materials.lacquer.alpha": 0.4}, lacquer=0.4)
        self.assert_same_bits(ptexp.render(scene), expected)

    def test_the_camera_in_a_scene_that_is_kept(self):
        scene, expected = self.changed({"camera.origin": (-1.0, 1, 4)}, x=-1.0)
        self.assert_same_bits(ptexp.render(scene), expected)
        for mode in ("serial", "megakernel", "wavefront"):
            other = ptexp.load(self.folder / "before.xml")
            other.params["camera.origin"] = (-1.0, 1, 4)
            self.assert_same_bits(ptexp.render(scene, mode=mode), ptexp.render(other, mode=mode))

    def test_back_again(self):
        scene = ptexp.load(self.write("room.xml", room()))
        before = ptexp.render(scene)
        old = dict(scene.params)
        for name, value, _ in self.CASES:
            scene.params[name] = value
        self.assert_other_image(before, ptexp.render(scene))
        scene.params.update(old)
        self.assert_same_bits(before, ptexp.render(scene))

    def test_a_camera_of_spheres(self):
        # Whose bounds and scans depend on where the camera is.
        moved = ptexp.load("spheres", width=40, height=30, spp=4)
        ptexp.render(moved)
        moved.params["camera.origin"] = (20, 5, -3)
        expected = ptexp.render("spheres", width=40, height=30, spp=4, look_from=(20, 5, -3))
        self.assert_same_bits(ptexp.render(moved), expected)

    def test_names_of_mitsuba(self):
        params = ptexp.load(self.write("room.xml", room())).params
        for name, ours in (("red.reflectance.value", "materials.red.albedo"), ("materials.red.reflectance", "materials.red.albedo"),
                           ("metal.specular_reflectance", "materials.metal.tint"), ("lacquer.int_ior", "materials.lacquer.eta"),
                           ("lacquer.alpha", "materials.lacquer.alpha"), ("lamp.emitter.radiance.value", "lights.lamp.radiance"),
                           ("lamp.radiance", "lights.lamp.radiance"), ("bulb.intensity", "lights.bulb.intensity")):
            self.assertIn(name, params)
            self.assertEqual(params[name], params[ours], name)
            self.assertNotIn(name, list(params))
        params["red.reflectance"] = (0.5, 0.25, 0.125)
        self.assertEqual(params["materials.red.albedo"], (0.5, 0.25, 0.125))
        params["metal.alpha"] = 0.5
        self.assertEqual((params["materials.metal.alpha_x"], params["materials.metal.alpha_y"]), (0.5, 0.5))

    def test_the_camera_is_as_written_and_as_a_matrix(self):
        scene = ptexp.load(self.write("room.xml", room()))
        params = scene.params
        self.assertEqual(params["camera.origin"], (0.5, 1, 4))
        self.assertEqual(params["camera.target"], (0, 0.5, 0))
        self.assertEqual(params["camera.up"], (0, 1, 0))
        m = np.array(params["camera.to_world"])
        self.assertEqual(m.tolist(), params["sensor.to_world"])
        forward = np.array([-0.5, -0.5, -4]) / np.sqrt(16.5)
        left = np.array([-4, 0, 0.5]) / np.sqrt(16.25)
        expected = np.column_stack([left, np.cross(forward, left), forward, [0.5, 1, 4]])
        np.testing.assert_allclose(m[:3], expected, atol=1e-6)
        before = ptexp.render(scene)
        params["camera.to_world"] = m  # the same view, rounded
        self.assertLess(ptexp.compare(before, ptexp.render(scene)).rmse, 0.05)
        turned = ptexp.Scene.from_dict({"type": "scene", "sensor": {"type": "perspective", "to_world": m}, "a": {"type": "cube"},
                                         "sky": {"type": "constant"}})
        np.testing.assert_allclose(turned.params["camera.to_world"], m, atol=1e-6)
        look = {"type": "lookat", "origin": (0.5, 1, 4), "target": np.array([0, 0.5, 0]), "up": [0, 1, 0]}
        sensor = {"type": "perspective", "to_world": look}
        written = ptexp.Scene.from_dict({"type": "scene", "sensor": sensor, "a": {"type": "cube"},
                                          "sky": {"type": "constant"}}).params
        self.assertEqual([written[f"camera.{name}"] for name in ("origin", "target", "up")],
                         [(0.5, 1, 4), (0, 0.5, 0), (0, 1, 0)])
        with self.assertRaisesRegex(ptexp.Error, "'to_world'.*expected type, origin, target and perhaps up"):
            ptexp.Scene.from_dict({"type": "scene", "sensor": {**sensor, "to_world": {**look, "direction": 1}}})
        for wrong in (np.diag([-1, 1, 1, 1]), np.zeros((4, 4)), np.eye(3), np.diag([1, 1, 1, 2])):
            with self.assertRaisesRegex(ptexp.Error, "camera.to_world: (expected a|9 numbers; expected 16)"):
                params["camera.to_world"] = wrong

    def test_names_are_completed_and_suggested(self):
        params = ptexp.load(self.write("room.xml", room())).params
        self.assertEqual(params._ipython_key_completions_(), list(params))
        for name, near in (("materials.red.albeda", "materials.red.albedo"), ("camera.targt", "camera.target"),
                           ("lights.lmp.radiance", "lights.lamp.radiance")):
            with self.assertRaisesRegex(KeyError, f"{name}.*did you mean '{near}'"):
                params[name]
            with self.assertRaisesRegex(KeyError, "did you mean"):
                params[name] = 1
            self.assertNotIn(name, params)
        for name in ("nothing like it", 3):
            with self.assertRaisesRegex(KeyError, "no parameter is called"):
                params[name]

    def test_names_and_values(self):
        params = ptexp.load(self.write("room.xml", room())).params
        self.assertAlmostEqual(params["camera.fov"], ROOM_VALUES["fov"], places=4)
        self.assertEqual(len(params["instances.1.to_world"]), 4)
        self.assertIn("materials.metal.eta", params)
        with self.assertRaises(KeyError):
            params["materials.green.albedo"] = 1
        with self.assertRaises(TypeError):
            del params["camera.fov"]
        self.assertEqual(params["instances.0.to_world"], [list(map(float, row)) for row in matrix(-1, np.float32(0.4))])
        params["materials.red.albedo"] = 0.25
        self.assertEqual(params["materials.red.albedo"], (0.25, 0.25, 0.25))
        self.assertIn("materials.red.albedo = (0.25, 0.25, 0.25)", repr(params).splitlines())
        for name, value in (("camera.origin", (1, 2)), ("camera.origin", (1, 2, 3, 4)), ("camera.fov", (40, 50)),
                            ("instances.0.to_world", np.zeros(17)), ("camera.origin", (1, 2, float("nan"))),
                            ("lights.lamp.radiance", -1), ("instances.0.to_world", np.zeros((4, 4)))):
            with self.assertRaises(ptexp.Error, msg=name):
                params[name] = value


PLACES = np.float32([[[1, 0, 0, -0.5], [0, 1, 0, 0.3], [0, 0, 1, 0.25], [0, 0, 0, 1]],
                     [[0.36, -0.8, 0, 0.5], [0.8, 0.6, 0.1, 0.5], [0, -0.1, 1, 0], [0, 0, 0, 1]]])
VIEWS = np.float32([[[1, 0, 0, 0], [0, 1, 0, -1], [0, 0, 1, 4], [0, 0, 0, 1]],
                    [[0.8, 0, 0.6, 0.2], [0, 1, 0, -1], [-0.6, 0, 0.8, 4], [0, 0, 0, 1]]])
ROOM_OF_PBRT = """Film "rgb" "integer xresolution" 32 "integer yresolution" 24
  Sampler "independent" "integer pixelsamples" 8
  PixelFilter "box"
  $view Camera "perspective" "float fov" 60 "float shutteropen" $open "float shutterclose" $close
  WorldBegin
  LightSource "infinite" "rgb L" [1 1 1]
  Material "diffuse" "rgb reflectance" [0.7 0.5 0.3]
  Shape "trianglemesh" "point3 P" [-9 0 -9  9 0 -9  9 0 9  -9 0 9] "integer indices" [0 1 2 0 2 3]
  ObjectBegin "thing"
    Shape "trianglemesh" "point3 P" [-0.5 0 0  0.5 0 0  0.5 1 0  -0.5 1 0] "integer indices" [0 1 2 0 2 3]
  ObjectEnd
  AttributeBegin $place ObjectInstance "thing" AttributeEnd
  AttributeBegin Translate 1 0.5 1 ObjectInstance "thing" AttributeEnd
"""


class Motion(TestCase):
    def room(self, place=(PLACES[0],) * 2, view=(VIEWS[0],) * 2, shutter=(0, 1)):
        """A pbrt file with the transforms at 0 s and at 1 s."""
        def active(matrices, directive):
            return " ".join(f"ActiveTransform {time} {directive} [{' '.join(map(str, matrix.T.ravel().tolist()))}]"
                            for time, matrix in zip(("StartTime", "EndTime"), matrices)) + " ActiveTransform All"

        values = {"view": active(view, "Transform"), "place": active(place, "ConcatTransform"), "open": shutter[0],
                  "close": shutter[1]}
        return self.write("room.pbrt", re.sub(r"\$([a-z]+)", lambda match: str(values[match[1]]), ROOM_OF_PBRT))

    def moving(self, matrices=PLACES):
        return list(zip((0, 1), matrices))

    def test_an_instance_has_the_bits_of_its_file(self):
        for shutter in ((0, 1), (-0.25, 0.75)):
            expected = ptexp.render(self.room(place=PLACES, shutter=shutter))
            scene = ptexp.load(self.room())
            still = scene.render()
            scene.params["instances.0.to_world"] = self.moving()
            scene.params["camera.shutter_open"], scene.params["camera.shutter_close"] = shutter
            self.assert_other_image(still, expected)
            for mode in ("serial", "megakernel", "wavefront"):
                self.assert_same_bits(scene.render(mode=mode), expected)
            self.assertEqual(scene.params["instances.0.to_world"], [(t, m.tolist()) for t, m in self.moving()])
            scene.params["instances.0.to_world"] = PLACES[0]
            self.assertEqual(scene.params["instances.0.to_world"], PLACES[0].tolist())
            self.assert_same_bits(scene.render(), still)

    def test_the_camera_has_the_bits_of_its_file(self):
        for handedness in (np.eye(4), np.diag([-1, 1, 1, 1])):
            self.check_camera(np.float32(handedness @ VIEWS))

    def check_camera(self, views):
        moving = ptexp.load(self.room(view=views))
        expected = moving.render()
        scene = ptexp.load(self.room(view=views[[0, 0]]))
        still = scene.render()
        self.assert_other_image(still, expected)
        keys = moving.params["camera.to_world"]
        for (time, matrix), expected_time, view in zip(keys, (0, 1), VIEWS):
            self.assertEqual(time, expected_time)
            np.testing.assert_allclose(matrix, np.linalg.inv(view), atol=1e-6)
        scene.params["sensor.to_world"] = keys
        self.assertEqual(scene.params["camera.to_world"], keys)
        self.assert_same_bits(scene.render(), expected)
        scene.params["camera.origin"] = scene.params["camera.origin"]  # the same: nothing
        self.assert_same_bits(scene.render(), expected)
        scene.params["camera.to_world"] = keys[0][1]
        self.assertEqual(scene.params["camera.to_world"], keys[0][1])
        self.assert_same_bits(scene.render(), still)

    def test_all_values_are_taken_back(self):
        scene = ptexp.load(self.room(place=PLACES, view=VIEWS))
        before, old = scene.render(), dict(scene.params)
        scene.params["instances.0.to_world"] = [[2, PLACES[1].ravel()], [3.5, PLACES[0].tolist()], (4, PLACES[0])]
        scene.params["camera.origin"] = (0, 2, -3)
        scene.params["camera.shutter_close"] = 3
        self.assertEqual([time for time, _ in scene.params["instances.0.to_world"]], [2, 3.5, 4])
        self.assert_other_image(scene.render(), before)
        scene.params.update(old)
        self.assert_same_bits(scene.render(), before)

    def test_errors_say_what_is_wrong(self):
        params = ptexp.load(self.room()).params
        a, b = PLACES
        nan = np.full((4, 4), np.nan)
        for name in ("instances.0.to_world", "camera.to_world"):
            before = params[name]
            for wrong, message in (
                    ([(1, a), (1, b)], "key 1 of its motion at 1 s; expected times that ascend"),
                    ([(1, a), (0.5, b)], "key 1 of its motion at 0.5 s"), ([(0, a), (float("inf"), b)], "key 1 .* at inf s"),
                    ([(float("nan"), a), (1, b)], "key 0 of its motion at nan s"), ([(0, a)], "1 key of a motion; expected two"),
                    ([(0, a), (1, nan)], "key 1: nan: expected finite numbers"), ([(0, a), (1, a[:3])], "key 1: 12 numbers; expected"),
                    ([(0, a), (1, np.diag([1, 1, 0, 1]))], "key 1: expected an affine map that can be inverted"),
                    ([(0, a), (1, np.diag([-1, 1, 1, 1]))], "key 1 of its motion mirrors"),
                    ([(0, a), b], "key 1: expected a pair of a time in seconds and a 4x4 matrix"),
                    ([("soon", a), (1, b)], "key 0: expected a pair"), ([(0, 1), (1, 2)], "key 0: 1 numbers"), ([], "0 numbers")):
                with self.assertRaisesRegex(ptexp.Error, f"^{name}: {message}"):
                    params[name] = wrong
                self.assertEqual(params[name], before)
        scene = ptexp.load(self.room(place=PLACES))
        scene.params["camera.shutter_open"] = 2
        with self.assertRaisesRegex(ptexp.Error, "the shutter opens at 2 s and closes at 1 s"):
            scene.render()

    def test_what_cannot_be_blurred_stands_as_it_begins(self):
        scene = ptexp.load(self.room())
        options = {"integrator": "mlt", "spp": 4}
        still = scene.render(**options)
        scene.params["instances.0.to_world"] = self.moving()
        with self.assertWarnsRegex(ptexp.SceneWarning, "--integrator mlt knows no motion blur"):
            self.assert_same_bits(scene.render(**options), still)
        strict = ptexp.load(self.room(), strict=True)
        strict.params["instances.0.to_world"] = self.moving()
        with self.assertRaisesRegex(ptexp.Error, "--integrator mlt knows no motion blur"):
            strict.render(**options)
        self.assert_same_bits(scene.render(), ptexp.render(self.room(place=PLACES)))

    def test_a_sphere_has_the_bits_of_its_file(self):
        def room(places):
            moves = " ".join(f"ActiveTransform {time} Translate {x} {y} {z}" for time, (x, y, z) in
                             zip(("StartTime", "EndTime"), places))
            return self.write("ball.pbrt", 'Film "rgb" "integer xresolution" 32 "integer yresolution" 24 Camera '
                              f'"perspective" WorldBegin LightSource "infinite" {moves} ActiveTransform All '
                              'Shape "sphere" "float radius" 0.5')

        places = [(-0.5, 0.25, 4), (1.5, -0.5, 3)]
        expected = ptexp.render(room(places), spp=4)
        scene = ptexp.load(room(places[:1] * 2), spp=4)
        still = scene.render()
        self.assert_other_image(still, expected)
        name, = (name for name in scene.params if name.endswith(".center"))
        keys = list(zip((0, 1), places))
        scene.params[name] = keys
        self.assert_same_bits(scene.render(), expected)
        self.assertEqual(scene.params[name], keys)
        self.assertEqual(ptexp.load(room(places)).params[name], keys)
        for wrong, message in (([(0, (1, 2)), (1, (1, 2, 3))], "key 0: 2 numbers; expected 3"),
                               ([(0, (1, 2, np.nan)), (1, (1, 2, 3))], "key 0: nan: expected finite"),
                               ([(0, (1, 2, 3)), 4], "key 1: expected a pair of a time in seconds and a point"),
                               ([(1, (1, 2, 3)), (1, (1, 2, 3))], "key 1 of its motion at 1 s")):
            with self.assertRaisesRegex(ptexp.Error, f"^{re.escape(name)}: {message}"):
                scene.params[name] = wrong
        scene.params[name] = places[0]
        self.assertEqual(scene.params[name], places[0])
        self.assert_same_bits(scene.render(), still)

    def test_layers_of_motion(self):
        scene = ptexp.load(self.room())
        scene.params["instances.0.to_world"] = self.moving()
        layer = scene.render(aov=("motion", "depth")).aovs["motion"]
        self.assertEqual(layer.shape, (24, 32, 2))
        self.assertGreater(np.abs(layer).max(), 1)
        self.assertFalse(layer[-1].any())  # the floor


class Dictionaries(TestCase):
    def scene(self, **shape):
        return {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": 5},
            "sensor": {"type": "perspective", "fov": 40.0, "to_world": [[-1, 0, 0, 0], [0, 1, 0, 1], [0, 0, -1, 4], [0, 0, 0, 1]],
                       "film": {"type": "hdrfilm", "width": 32, "height": 24, "rfilter": {"type": "box"}},
                       "sampler": {"type": "independent", "sample_count": 4}},
            "red": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.8, 0.2, 0.1]}},
            "floor": {"bsdf": {"type": "ref", "id": "red"}, **shape},
            "sky": {"type": "constant", "radiance": 1.0},
        }

    XML = """<scene version="3.0.0"><integrator type="path"><integer name="max_depth" value="5"/></integrator>
      <sensor type="perspective"><float name="fov" value="40"/>
        <transform name="to_world"><matrix value="-1 0 0 0  0 1 0 1  0 0 -1 4  0 0 0 1"/></transform>
        <film type="hdrfilm"><integer name="width" value="32"/><integer name="height" value="24"/>
          <rfilter type="box"/></film>
        <sampler type="independent"><integer name="sample_count" value="4"/></sampler></sensor>
      <bsdf type="diffuse" id="red"><rgb name="reflectance" value="0.8, 0.2, 0.1"/></bsdf>
      <shape type="%s">%s<ref id="red"/></shape>
      <emitter type="constant"><float name="radiance" value="1"/></emitter></scene>"""

    def test_a_dictionary_is_its_file(self):
        path = self.write("cube.xml", self.XML % ("cube", ""))
        scene = ptexp.Scene.from_dict(self.scene(type="cube"))
        self.assertIn("materials.red.albedo", scene.params)
        self.assert_same_bits(ptexp.render(scene), ptexp.render(path))

    def test_a_mesh_of_arrays_is_its_file(self):
        vertices = np.array([[-1, 0, 0], [1, 0, 0], [1, 2, -1], [-1, 2, -1]], dtype=np.float32)
        triangles = np.array([[0, 1, 2], [0, 2, 3]])
        lines = ["ply", "format ascii 1.0", "element vertex 4", *(f"property float {c}" for c in "xyz"),
                 "element face 2", "property list uchar int vertex_indices", "end_header",
                 *(" ".join(map(str, v)) for v in vertices.tolist()), *("3 " + " ".join(map(str, t)) for t in triangles.tolist())]
        self.write("wall.ply", "\n".join(lines) + "\n")
        flags = '<boolean name="face_normals" value="true"/>'
        path = self.write("wall.xml", self.XML % ("ply", f'<string name="filename" value="wall.ply"/>{flags}'))
        scene = ptexp.Scene.from_dict(self.scene(type="mesh", vertices=vertices, triangles=triangles, face_normals=True))
        self.assert_same_bits(ptexp.render(scene), ptexp.render(path))

    def test_normals_and_coordinates_are_those_of_a_file(self):
        vertices = np.array([[-1, 0, 0], [1, 0, 0], [1, 2, -1], [-1, 2, -1]], dtype=np.float32)
        normals = np.array([[-0.6, 0, 0.8], [0.6, 0, 0.8], [0, 0.6, 0.8], [0, 0, 1]], dtype=np.float32)
        uvs = np.array([[0, 0], [2, 0], [2, 1], [0, 1]], dtype=np.float32)
        # v is 0 at a picture's foot, as in OBJ.
        lines = [f"{key} " + " ".join(map(repr, row)) for key, rows in (("v", vertices), ("vn", normals), ("vt", uvs))
                 for row in rows.astype(float).tolist()]
        self.write("wall.obj", "\n".join([*lines, "f 1/1/1 2/2/2 3/3/3", "f 1/1/1 3/3/3 4/4/4"]) + "\n")
        board = '<bsdf type="diffuse"><texture name="reflectance" type="checkerboard"/></bsdf>'
        lamp = ('<emitter type="point"><transform name="to_world"><translate x="1" y="2" z="3"/></transform>'
                "</emitter></scene>")
        path = self.write("wall.xml", (self.XML % ("obj", '<string name="filename" value="wall.obj"/>'))
                          .replace('<ref id="red"/>', board).replace("</scene>", lamp))
        mesh = {"type": "mesh", "vertices": vertices, "faces": [[0, 1, 2], [0, 2, 3]], "normals": normals, "uvs": uvs,
                "bsdf": {"type": "diffuse", "reflectance": {"type": "checkerboard"}}}

        def image(**changed):
            point = {"type": "point", "to_world": [[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]}
            return ptexp.render(ptexp.Scene.from_dict({**self.scene(**{**mesh, **changed}), "lamp": point}))

        expected = ptexp.render(path)
        self.assert_same_bits(image(), expected)
        self.assert_other_image(image(normals=None), expected)
        self.assert_other_image(image(uvs=2 * uvs), expected)
        self.assert_same_bits(image(face_normals=True), image(face_normals=True, normals=None))
        self.assert_same_bits(image(face_normals=False), expected)

    def test_a_value_has_many_forms(self):
        class Wrapped:
            def __init__(self, matrix):
                self.matrix = matrix

        place = [[2.0, 0, 0, 0.5], [0, 1, 0, 0.25], [0, 0, 1, 0], [0, 0, 0, 1]]

        def image(to_world=place, reflectance=(0.8, 0.2, 0.1), **more):
            scene = self.scene(type="cube", to_world=to_world)
            scene["red"] = {"type": "diffuse", "reflectance": reflectance}
            return ptexp.render(ptexp.Scene.from_dict({**scene, **more}))

        expected = image()
        self.assert_other_image(expected, image(to_world=np.eye(4)))
        for same in (np.array(place), place[:3], [x for row in place for x in row], Wrapped(np.array(place)),
                     [np.array(row) for row in place]):
            self.assert_same_bits(image(to_world=same), expected)
        for same in (np.array([0.8, 0.2, 0.1]), {"type": "rgb", "value": "0.8, 0.2, 0.1"},
                     {"type": "rgb", "value": (0.8, 0.2, 0.1)}):
            self.assert_same_bits(image(reflectance=same), expected)
        grey = image(reflectance=0.5)
        for same in ({"type": "rgb", "value": 0.5}, np.float64(0.5), {"type": "spectrum", "value": 0.5}):
            self.assert_same_bits(image(reflectance=same), grey)
        self.assert_same_bits(image(reflectance={"type": "rgb", "value": 1}), image(reflectance=(1, 1, 1)))
        paint = {"type": "diffuse", "id": "paint", "reflectance": (0.8, 0.2, 0.1)}
        named = {"type": "cube", "to_world": place, "bsdf": {"type": "ref", "id": "paint"}}
        self.assert_same_bits(image(floor=named, any=paint), expected)

    def test_errors_say_where(self):
        deep = {"type": "twosided", "bsdf": {"type": "diffuse"}}
        for _ in range(70):
            deep = {"type": "mask", "bsdf": deep}
        with self.assertRaisesRegex(ptexp.Error, "nested deeper than 64"):
            ptexp.Scene.from_dict({"type": "scene", "a": deep})
        mesh = {"type": "mesh", "vertices": np.eye(3), "triangles": [[0, 1, 2]]}
        for part, width in (("normals", 3), ("uvs", 2)):
            with self.assertRaisesRegex(ptexp.Error, f"2 {part} for 3 vertices"):
                ptexp.Scene.from_dict(self.scene(**mesh, **{part: np.ones((2, width))}))
            with self.assertRaisesRegex(ptexp.Error, f"{part}: 4 columns"):
                ptexp.Scene.from_dict(self.scene(**mesh, **{part: np.ones((3, 4))}))
        cases = [
            (self.scene(type="cubic"), r"scene\['floor'\]: type 'cubic'"),
            (self.scene(type="mesh", vertices=np.zeros((3, 3))), "triangles"),
            (self.scene(type="mesh", vertices=np.zeros((3, 3)), triangles=[[0, 1, 3]]), "triangle 0 has vertex 3"),
            (self.scene(type="cube", to_world=[1, 2]), r"scene\['floor'\]\['to_world'\]: 2 numbers"),
            ({"type": "cube"}, "'scene'"),
        ]
        for scene, message in cases:
            with self.assertRaisesRegex(ptexp.Error, message):
                ptexp.Scene.from_dict(scene)
        with self.assertWarnsRegex(ptexp.SceneWarning, r"scene\['floor'\].*sharpness"):
            ptexp.Scene.from_dict(self.scene(type="cube", sharpness=3))
        with self.assertRaisesRegex(ptexp.Error, "sharpness"):
            ptexp.Scene.from_dict(self.scene(type="cube", sharpness=3), strict=True)


if __name__ == "__main__":
    unittest.main()
