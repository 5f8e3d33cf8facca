// Transforms, shapes, cameras. Numbers called golden come from Mitsuba 3.9.1 (scalar_rgb);
// test_mitsuba_reference.py compares more, where Mitsuba is installed.
#include <gtest/gtest.h>

#include "common/scene/data/camera.h"
#include "load/expect_near.h"
#include "load/mitsuba_scene.h"

namespace pt {
namespace {

/// A shape with a transform of these steps.
std::string shape(const std::string& type, const std::string& steps,
                  const std::string& inside = "") {
  return "<shape type=\"" + type + "\"><transform name=\"to_world\">" + steps + "</transform>" +
         inside + "</shape>";
}

/// The corner of a rectangle that was at (-1, -1, 0), the edge along x and the one along y.
Quad square_after(const std::string& steps) {
  const SceneData scene = load_xml(shape("rectangle", steps)).scene;
  return scene.quads.at(0);
}

TEST(MitsubaTransform, stepsAreAppliedInTheirOrder) {
  const Quad quad =
      square_after("<translate x=\"1\"/><rotate y=\"1\" angle=\"90\"/><scale value=\"2\"/>");
  // By hand: (-1, -1, 0) -> (0, -1, 0) -> (0, -1, 0) -> (0, -2, 0); x -> -z, doubled.
  expect_near(quad.corner, {0, -2, 0});
  expect_near(quad.edge_a, {0, 0, -4});
  expect_near(quad.edge_b, {0, 4, 0});
}

TEST(MitsubaTransform, matricesAreRowByRow) {
  const Quad quad = square_after("<matrix value=\"1 2 3 4 5 6 7 8 10 9 9 1 0 0 0 1\"/>");
  expect_near(quad.corner, {4 - 1 - 2, 8 - 5 - 6, 1 - 10 - 9});
  expect_near(quad.edge_a + quad.edge_b, {2 + 4, 10 + 12, 20 + 18});
  const Quad small = square_after("<matrix value=\"1 2 3, 4 5 6, 7 8 10\"/>");
  expect_near(small.corner, {-3, -9, -15});
}

TEST(MitsubaTransform, lookatIsMitsubas) {
  // Golden: the cube's vertex (1, -1, -1) under this lookat.
  const SceneData scene =
      load_xml(shape("cube", "<lookat origin=\"1,2,3\" target=\"4,5,7\" up=\"0,1,0\"/>")).scene;
  float nearest = 1e30f;
  for (const Quad& q : scene.quads) {
    for (const Vec3& p : {q.corner, q.corner + q.edge_a, q.corner + q.edge_b}) {
      nearest = std::min(nearest, glm::length(p - Vec3(1.5942f, 0.62801f, 2.1256f)));
    }
  }
  EXPECT_LT(nearest, 1e-4f);
}

TEST(MitsubaTransform, badOnesAreErrors) {
  const auto expect_bad = [](const std::string& steps, const std::string& part) {
    expect_error([&] { square_after(steps); }, part);
  };
  expect_bad("<scale value=\"0\"/>", "singular");
  expect_bad("<scale x=\"0\"/>", "singular");
  expect_bad("<matrix value=\"1 1 0 1 1 0 0 0 1\"/>", "singular");
  expect_bad("<matrix value=\"1 2 3\"/>", "expected 16 or 9");
  expect_bad("<matrix value=\"1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1\"/>", "not affine");
  expect_bad("<matrix value=\"nan 0 0 0 1 0 0 0 1\"/>", "expected a number");
  expect_bad("<rotate angle=\"5\"/>", "length zero");
  expect_bad("<lookat origin=\"1,1,1\" target=\"1,1,1\"/>", "same point");
  expect_bad("<lookat origin=\"0,0,0\" target=\"0,2,0\" up=\"0,1,0\"/>", "parallel");
  expect_bad("<scale value=\"1e30\"/><scale value=\"1e30\"/>", "overflows");
  expect_bad("<wobble/>", "<wobble> in <transform>");
  EXPECT_NO_THROW(square_after("<scale value=\"1e-8\"/>"));
  EXPECT_NO_THROW(square_after("<scale z=\"1e-8\"/>"));
}

TEST(MitsubaShape, sidesFollowMitsuba) {
  const std::string flip = "<boolean name=\"flip_normals\" value=\"true\"/>";
  const std::string mirror = "<scale x=\"-1\"/>";
  EXPECT_EQ(square_after("").normal, Vec3(0, 0, 1));
  EXPECT_EQ(square_after(mirror).normal, Vec3(0, 0, 1));
  const auto flipped = [&](const std::string& steps) {
    return load_xml(shape("rectangle", steps, flip)).scene.quads.at(0).normal;
  };
  EXPECT_EQ(flipped(""), Vec3(0, 0, -1));
  EXPECT_EQ(flipped(mirror), Vec3(0, 0, -1));
  for (const std::string& steps : {std::string(), mirror}) {
    for (const bool inward : {false, true}) {
      const SceneData cube = load_xml(shape("cube", steps, inward ? flip : "")).scene;
      ASSERT_EQ(cube.quads.size(), 6u);
      for (const Quad& q : cube.quads) {
        const Vec3 center = q.corner + 0.5f * (q.edge_a + q.edge_b);
        EXPECT_EQ(glm::dot(center, q.normal), inward ? -1.0f : 1.0f);
      }
    }
  }
}

TEST(MitsubaShape, sphereKeepsItsCenterAndRadius) {
  const SceneData scene = load_xml(shape("sphere", "<scale value=\"2\"/><translate x=\"10\"/>",
                                         "<point name=\"center\" value=\"1,2,3\"/>"
                                         "<float name=\"radius\" value=\".5\"/>"))
                              .scene;
  ASSERT_EQ(scene.spheres.size(), 1u);
  EXPECT_EQ(scene.spheres[0].center, Vec3(12, 4, 6));  // golden: the box is (11..13, 3..5, 5..7)
  EXPECT_EQ(scene.spheres[0].radius_squared, 1.0f);
}

/// Signed volume of a closed mesh; positive where triangles face outward.
double volume(const Mesh& mesh) {
  double sum = 0;
  for (const TriangleIndices& t : mesh.triangles) {
    const glm::dvec3 a = mesh.positions[t.v[0]], b = mesh.positions[t.v[1]];
    sum += glm::dot(a, glm::cross(b, glm::dvec3(mesh.positions[t.v[2]]))) / 6.0;
  }
  return sum;
}

double area(const Mesh& mesh) {
  double sum = 0;
  for (const TriangleIndices& t : mesh.triangles) {
    const glm::dvec3 a = mesh.positions[t.v[0]], b = mesh.positions[t.v[1]];
    sum += 0.5 * glm::length(glm::cross(b - a, glm::dvec3(mesh.positions[t.v[2]]) - a));
  }
  return sum;
}

Mesh only_mesh(const std::string& xml) {
  const SceneData scene = load_xml(xml).scene;
  EXPECT_EQ(scene.meshes.size(), 1u);
  return scene.meshes.at(0);
}

TEST(MitsubaShape, tessellationsHaveTheAreaOfTheirShape) {
  const double pi_ = std::acos(-1.0);
  const Mesh ellipsoid = only_mesh(shape("sphere", "<scale value=\"1 2 3\"/>"));
  EXPECT_NEAR(volume(ellipsoid), 8 * pi_, 8 * pi_ * 4e-4);
  const Mesh inside_out = only_mesh(shape("sphere", "<scale value=\"1 2 3\"/>",
                                          "<boolean name=\"flip_normals\" value=\"true\"/>"));
  EXPECT_NEAR(volume(inside_out), -8 * pi_, 8 * pi_ * 4e-4);
  EXPECT_NEAR(area(only_mesh(shape("disk", "<scale value=\"2\"/>"))), 4 * pi_, 2e-3);
  EXPECT_NEAR(area(only_mesh(shape("cylinder", "",
                                   "<point name=\"p0\" value=\"1,1,1\"/>"
                                   "<point name=\"p1\" value=\"1,1,4\"/>"
                                   "<float name=\"radius\" value=\"0.5\"/>"))),
              3 * pi_, 1e-3);
}

TEST(MitsubaShape, disksKnowHowFarTheirAnglesAreApart) {
  const SceneData scene =
      load_xml(shape("disk", "",
                     "<bsdf type=\"bumpmap\"><texture type=\"checkerboard\"/><bsdf "
                     "type=\"diffuse\"/></bsdf>"))
          .scene;
  const Mesh& mesh = scene.meshes.at(0);
  EXPECT_NEAR(area(mesh), std::acos(-1.0), 5e-4);
  double error = 0;  // of dp/dv, along the circle 2 pi r, on average over the area
  for (const TriangleIndices& t : mesh.triangles) {
    const auto& [a, b, c] = t.v;
    const Vec3 p = mesh.positions[b] - mesh.positions[a], q = mesh.positions[c] - mesh.positions[a];
    const Vec2 s = mesh.uvs[b] - mesh.uvs[a], r = mesh.uvs[c] - mesh.uvs[a];
    const Vec3 dp_dv = (-r.x * p + s.x * q) / (s.x * r.y - s.y * r.x);
    const Vec3 middle = (mesh.positions[a] + mesh.positions[b] + mesh.positions[c]) / 3.0f;
    const Vec3 exact = 2 * pi * Vec3(middle.y, -middle.x, 0);  // our v goes the other way
    error += 0.5 * glm::length(glm::cross(p, q)) * glm::length(dp_dv - exact) / glm::length(exact);
  }
  EXPECT_LT(error / std::acos(-1.0), 0.03);
}

TEST(MitsubaShape, normalsAreOnTheSideOfTheTriangles) {
  for (const std::string type : {"sphere", "disk", "cylinder"}) {
    for (const std::string steps : {"", "<scale x=\"-1\"/>", "<scale value=\"1 2 3\"/>"}) {
      for (const std::string flip : {"", "<boolean name=\"flip_normals\" value=\"true\"/>"}) {
        const SceneData scene = load_xml(shape(type, steps, flip)).scene;
        for (const Mesh& mesh : scene.meshes) {
          for (const TriangleIndices& t : mesh.triangles) {
            const Vec3& a = mesh.positions[t.v[0]];
            const Vec3 n = glm::cross(mesh.positions[t.v[1]] - a, mesh.positions[t.v[2]] - a);
            ASSERT_GT(glm::dot(n, mesh.normals[t.v[0]]), 0.0f) << type << steps << flip;
          }
        }
      }
    }
  }
}

TEST(MitsubaShape, meshesWithoutNormalsGetThem) {
  const TempFolder folder;
  write_text(folder.file("t.obj"),
             "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\n"
             "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const auto load = [&](const std::string& inside) {
    write_text(folder.file("scene.xml"),
               "<scene version=\"3.0.0\"><shape type=\"obj\"><string name=\"filename\" "
               "value=\"t.obj\"/>" +
                   inside + "</shape></scene>");
    return load_mitsuba_xml(folder.file("scene.xml")).meshes.at(0);
  };
  const Mesh smooth = load("");
  ASSERT_EQ(smooth.normals.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {  // golden
    const Vec3 p = smooth.positions[i];
    if (p == Vec3(0.0f)) expect_near(smooth.normals[i], Vec3(-0.57735f));
    if (p == Vec3(1, 0, 0)) expect_near(smooth.normals[i], {0.791601f, -0.41149f, -0.451712f});
  }
  EXPECT_GT(volume(smooth), 0);
  const Mesh flat = load("<boolean name=\"face_normals\" value=\"true\"/>");
  EXPECT_TRUE(flat.normals.empty());
  EXPECT_LT(volume(load("<boolean name=\"face_normals\" value=\"true\"/>"
                        "<boolean name=\"flip_normals\" value=\"true\"/>")),
            0);
}

TEST(MitsubaShape, instancesRepeatAGroup) {
  const LoadedScene loaded = load_xml(
      "<shape type=\"instance\"><ref id=\"g\"/><transform name=\"to_world\">"
      "<translate x=\"5\"/></transform></shape>"
      "<shape type=\"instance\"><ref id=\"g\"/></shape>"
      "<shape type=\"shapegroup\" id=\"g\"><shape type=\"cube\"/><shape type=\"rectangle\"/>"
      "</shape><shape type=\"shapegroup\" id=\"unused\"><shape type=\"cube\"/></shape>");
  ASSERT_EQ(loaded.scene.instances.size(), 2u);
  EXPECT_EQ(loaded.scene.meshes.size(), 2u);
  EXPECT_TRUE(loaded.scene.quads.empty());
  for (const Mesh& mesh : loaded.scene.meshes) EXPECT_EQ(mesh.group, 1u);
  EXPECT_EQ(loaded.scene.instances[0].group, 1u);
  EXPECT_EQ(loaded.scene.instances[0].to_world.translation(), Vec3(5, 0, 0));
}

TEST(MitsubaShape, nullSurfacesAreNotThere) {
  const LoadedScene loaded = load_xml(
      "<sensor type=\"perspective\"/><emitter type=\"constant\"/>"
      "<shape type=\"cube\"><bsdf type=\"null\"/></shape>");
  EXPECT_TRUE(loaded.scene.quads.empty());
  EXPECT_TRUE(loaded.warnings.empty());
}

Camera camera_of(const std::string& sensor) {
  const SceneData scene = load_xml(sensor).scene;
  return make_camera(scene.camera, *scene.defaults.width, *scene.defaults.height);
}

std::string perspective(const std::string& inside) {
  return "<sensor type=\"perspective\">" + inside +
         "<film type=\"hdrfilm\"><integer name=\"width\" value=\"200\"/>"
         "<integer name=\"height\" value=\"100\"/></film></sensor>";
}

TEST(MitsubaSensor, fieldOfViewFollowsItsAxis) {
  // Golden: the ray through the upper left corner of 200 x 100 pixels.
  const auto expect_corner = [](const std::string& inside, const Vec3& direction) {
    expect_near(camera_ray(camera_of(perspective(inside)), 0, 0, 0.5f, 0.5f).direction, direction);
  };
  const std::string fov = "<float name=\"fov\" value=\"60\"/>";
  const auto axis = [](const std::string& name) {
    return "<string name=\"fov_axis\" value=\"" + name + "\"/>";
  };
  expect_corner(fov, {0.485071f, 0.242536f, 0.840168f});
  expect_corner(fov + axis("x"), {0.485071f, 0.242536f, 0.840168f});
  expect_corner(fov + axis("larger"), {0.485071f, 0.242536f, 0.840168f});
  expect_corner(fov + axis("y"), {0.707107f, 0.353553f, 0.612372f});
  expect_corner(fov + axis("smaller"), {0.707107f, 0.353553f, 0.612372f});
  expect_corner(fov + axis("diagonal"), {0.447214f, 0.223607f, 0.866025f});
  expect_corner("<string name=\"focal_length\" value=\"35mm\"/>",
                {0.470261f, 0.235131f, 0.850628f});
  expect_error([&] { camera_of(perspective(fov + axis("w"))); }, "fov_axis 'w'");
  expect_error([&] { camera_of(perspective("<float name=\"fov\" value=\"180\"/>")); }, "fov 180");
}

TEST(MitsubaSensor, leftIsLeftAndUpIsUp) {
  const std::string fov = "<float name=\"fov\" value=\"60\"/>";
  const std::string look = "<lookat origin=\"1,2,3\" target=\"4,5,6\" up=\"0,1,0\"/>";
  const Camera camera =
      camera_of(perspective(fov + "<transform name=\"to_world\">" + look + "</transform>"));
  const Camera mirrored = camera_of(
      perspective(fov + "<transform name=\"to_world\">" + look + "<scale x=\"-1\"/></transform>"));
  const auto direction = [](const Camera& c, float x, float y) {
    return camera_ray(c, x, y, 0.5f, 0.5f).direction;
  };
  // Golden, of both.
  expect_near(direction(camera, 0, 0), {0.729054f, 0.683101f, 0.0430593f});
  expect_near(direction(camera, 200, 0), {0.0430594f, 0.683101f, 0.729054f});
  expect_near(direction(camera, 0, 100), {0.927083f, 0.287042f, 0.241089f});
  expect_near(direction(mirrored, 0, 0), {-0.729054f, 0.683101f, 0.0430593f});
  expect_near(direction(mirrored, 200, 0), {-0.0430594f, 0.683101f, 0.729054f});
  expect_near(direction(mirrored, 0, 100), {-0.927083f, 0.287042f, 0.241089f});
}

TEST(MitsubaSensor, thinLensAndDefaults) {
  const SceneData scene =
      load_xml(
          "<sensor type=\"thinlens\"><float name=\"aperture_radius\" value=\"0.25\"/>"
          "<float name=\"focus_distance\" value=\"7\"/><sampler type=\"independent\">"
          "<integer name=\"sample_count\" value=\"33\"/></sampler></sensor>")
          .scene;
  EXPECT_EQ(scene.camera.aperture, 0.5f);
  EXPECT_EQ(scene.camera.focus_distance, 7.0f);
  EXPECT_EQ(scene.defaults.spp, 33);
  EXPECT_EQ(scene.defaults.width, 768);
  EXPECT_EQ(scene.defaults.height, 576);
}

}  // namespace
}  // namespace pt
