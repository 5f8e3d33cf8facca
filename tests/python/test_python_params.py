"""Parameters that are changed give the bits of a file that has the values; so do dictionaries."""
import unittest

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
    ]

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

    def test_two_numbers_of_a_material(self):
        values = {"materials.metal.alpha_x": 0.5, "materials.metal.alpha_y": 0.5}
        scene, expected = self.changed(values, alpha=0.5)
        self.assert_same_bits(ptexp.render(scene), expected)

    def test_what_is_precomputed_follows(self):
        scene, expected = self.changed({"materials.lacquer.alpha": 0.4}, lacquer=0.4)
        self.assert_same_bits(ptexp.render(scene), expected)

    def test_the_camera_in_a_scene_that_is_kept(self):
        scene, expected = self.changed({"camera.origin": (-1.0, 1, 4)}, x=-1.0)
        self.assertLess(np.abs(np.asarray(ptexp.render(scene)) - np.asarray(expected)).max(), 1.0)
        difference = ptexp.compare(ptexp.render(scene), expected)
        # A file's camera is a matrix, from which the target is made again: rounded.
        self.assertLess(difference.rmse, 0.05)
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
