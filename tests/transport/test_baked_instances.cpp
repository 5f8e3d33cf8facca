// An instance against its baked copy: the same triangles, placed by a transform or placed already.
// Both images are made from the same random numbers, so they are equal pixel by pixel but for
// rounding: no noise hides what is wrong.
#include "common/scene/prepare/prepare_scene.h"
#include "mode_cases.h"
#include "render_serial.h"
#include "statistics.h"

namespace pt {
namespace {

/// A tetrahedron that pretends to be round: normals by vertex.
Mesh smooth_body(std::uint32_t material) {
  Mesh mesh;
  mesh.positions = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  mesh.triangles = {{{0, 1, 2}}, {{0, 3, 1}}, {{0, 2, 3}}, {{1, 3, 2}}};
  for (const Vec3& p : mesh.positions) mesh.normals.push_back(glm::normalize(p));
  mesh.material = material;
  return mesh;
}

/// Flat triangles. They have texture coordinates: without any a mirrored triangle, whose vertices
/// are turned when it is baked, would show its texture from another corner.
Mesh wedge(std::uint32_t material) {
  Mesh mesh;
  mesh.positions = {{-1, 0, -1}, {1, 0, -1}, {0, 1.5f, 0}, {0, 0, 1}};
  mesh.triangles = {{{0, 2, 1}}, {{0, 3, 2}}, {{1, 2, 3}}};
  mesh.uvs = {{0, 0}, {1, 0.2f}, {0.4f, 1}, {0.7f, 0.6f}};
  mesh.material = material;
  return mesh;
}

/// A lamp that shines downwards, of a colour that changes along it.
Mesh striped_lamp(std::uint32_t material) {
  Mesh mesh;
  mesh.positions = {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}};
  mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 0.4f}, {0, 0.7f}};
  mesh.material = material;
  return mesh;
}

/// The copy that an instance stands for. A mirroring transform keeps the side that shines, so the
/// order of the vertices is turned.
Mesh baked(Mesh mesh, const Affine& to_world) {
  const Affine to_object = inverse(to_world);
  for (Vec3& p : mesh.positions) p = to_world.point(p);
  for (Vec3& n : mesh.normals) n = glm::normalize(to_object.transposed(n));
  if (to_world.determinant() < 0) {
    for (TriangleIndices& t : mesh.triangles) std::swap(t.v[1], t.v[2]);
  }
  return mesh;
}

std::uint32_t add_texture(SceneData& scene) {
  Texture checker;
  checker.kind = TextureKind::checkerboard;
  checker.color0 = {1, 0.2f, 0.6f}, checker.color1 = {0.1f, 0.9f, 0.3f};
  checker.u_row[0] = 1.7f, checker.u_row[1] = 0.3f, checker.v_row[1] = 2.2f;
  scene.textures.push_back(checker);
  return static_cast<std::uint32_t>(scene.textures.size()) - 1;
}

/// Everything placed by `to_world`: a smooth body, a textured wedge and a textured lamp.
SceneData placed_scene(bool instances, const Affine (&to_world)[3], MaterialKind body) {
  SceneData scene;
  scene.name = "placed";
  Mesh floor;
  floor.positions = {{-9, 0, -9}, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}};
  floor.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  floor.material = scene.add_material(make_diffuse({0.7f, 0.6f, 0.4f}));
  Mesh meshes[3] = {
      smooth_body(scene.add_material(body == kind_of<Metal> ? make_metal(Color(0.9f), 0.2f)
                                                            : make_diffuse(Color(0.8f)))),
      wedge(scene.add_material(make_diffuse(Color(0.9f)))),
      striped_lamp(scene.add_material(make_diffuse(Color(0.0f), {9, 8, 7})))};
  scene.materials[meshes[1].material].parameters[0].texture = add_texture(scene);
  scene.materials[meshes[2].material].emission.texture = add_texture(scene);
  for (std::uint32_t i = 0; i < 3; ++i) {
    if (instances) {
      meshes[i].group = i + 1;
      scene.instances.push_back({i + 1, to_world[i]});
    } else {
      meshes[i] = baked(meshes[i], to_world[i]);
    }
    scene.meshes.push_back(meshes[i]);
  }
  scene.meshes.push_back(floor);
  scene.sky = {Color(0.1f), {0.1f, 0.2f, 0.3f}};
  scene.camera = {{1, 4, 7}, {0, 0.8f, 0}, {0, 1, 0}, 45.0f, 0.0f, 7.0f};
  return scene;
}

Image image_of(SceneData scene, const Options& options) {
  prepare_scene(scene, options);
  return render(scene, options).image;
}

/// Rounding may send a path another way at an edge: so few pixels may differ.
void expect_nearly_equal(const Image& a, const Image& b, double allowed) {
  std::size_t far = 0;
  double sum = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) {
    const float scale = 0.02f + std::max(a.rgb[i], b.rgb[i]);
    far += std::abs(a.rgb[i] - b.rgb[i]) > 2e-3f * scale;
    sum += a.rgb[i];
  }
  EXPECT_GT(sum, 0.1 * static_cast<double>(a.rgb.size())) << "too dark to tell";
  EXPECT_LE(static_cast<double>(far), allowed * static_cast<double>(a.rgb.size()));
}

struct Placement {
  const char* name;
  Affine body, wedge, lamp;
};

const Placement placements[] = {
    {"moved", translate({-1.5f, 1, 0.5f}), translate({1.5f, 0.1f, -0.5f}), translate({0, 3, 0})},
    {"stretched", translate({-1.5f, 1, 0}) * rotate({1, 2, 0.5f}, 50) * scale({0.4f, 1.5f, 0.8f}),
     translate({1.5f, 0.1f, 0}) * rotate({0, 1, 0}, 20) * scale({0.5f, 1.6f, 1.2f}),
     translate({0, 3, 0}) * rotate({0, 0, 1}, 20) * scale({0.5f, 1, 1.8f})},
    {"mirrored", translate({-1.5f, 1, 0}) * rotate({1, 0, 2}, 30) * scale({-0.5f, 1.4f, 0.9f}),
     translate({1.5f, 0.1f, 0}) * rotate({0, 1, 0}, 70) * scale({1.3f, 1.2f, -0.6f}),
     translate({0, 3, 0}) * rotate({1, 0, 0}, 15) * scale({-1.6f, 1, 0.7f})},
};

TEST(BakedInstances, AreEqualPixelByPixel) {
  for (const Placement& p : placements) {
    const Affine to_world[3] = {p.body, p.wedge, p.lamp};
    for (const MaterialKind body : {kind_of<Diffuse>, kind_of<Metal>}) {
      for (const bool nee : {true, false}) {
        SCOPED_TRACE(testing::Message() << p.name << ", nee " << nee);
        Options options = image_options(48, 36, 8, 4);
        options.nee = nee;
        expect_nearly_equal(image_of(placed_scene(true, to_world, body), options),
                            image_of(placed_scene(false, to_world, body), options), 0.01);
      }
    }
  }
}

// Two instances of one group, one of them mirrored, and a lamp that is both.
TEST(BakedInstances, AGroupPlacedTwiceShinesTwice) {
  const Affine places[2] = {placements[1].lamp, translate({2, 1.5f, 0}) * placements[2].lamp};
  SceneData placed, world;
  for (SceneData* scene : {&placed, &world}) {
    const bool instances = scene == &placed;
    *scene = placed_scene(false, {placements[1].body, placements[1].wedge, placements[1].lamp},
                          kind_of<Diffuse>);
    const std::uint32_t material = scene->meshes[2].material;
    scene->meshes.erase(scene->meshes.begin() + 2);
    Mesh lamp = striped_lamp(material);
    for (const Affine& place : places) {
      if (instances) {
        scene->instances.push_back({1, place});
      } else {
        scene->meshes.push_back(baked(lamp, place));
      }
    }
    lamp.group = 1;
    if (instances) scene->meshes.push_back(lamp);
  }
  const Options options = image_options(48, 36, 8, 4);
  expect_nearly_equal(image_of(placed, options), image_of(world, options), 0.01);
}

/// A mirror with three different normals, seen in one of its points; what it shows of a gradient
/// tells the normal there.
Color seen_in_the_mirror(const Vec3 (&normals)[3], const Vec3& b, bool instance) {
  SceneData scene;
  scene.name = "mirror";
  Mesh mesh;
  mesh.positions = {{-1, 0, -1}, {-1, 0, 1}, {1, 0, -1}};
  mesh.normals = {normals[0], normals[1], normals[2]};
  mesh.triangles = {{{0, 1, 2}}};
  mesh.material = scene.add_material(make_metal(Color(1.0f), 0));
  const Vec3 at = b.x * mesh.positions[0] + b.y * mesh.positions[1] + b.z * mesh.positions[2];
  scene.camera = {at + Vec3(0.5f, 2, 0.25f), at, {0, 0, 1}, 0.001f, 0.0f, 2.0f};
  if (instance) {
    mesh.group = 1;
    scene.instances.push_back({1, {}});
  }
  scene.meshes.push_back(mesh);
  scene.sky = {Color(0.0f), Color(1.0f)};
  const Image image = image_of(scene, image_options(4, 4, 4, 3));
  return {image.rgb[0], image.rgb[1], image.rgb[2]};
}

TEST(ShadingNormal, OfThreeDifferentVerticesIsInterpolated) {
  const Vec3 normals[3] = {glm::normalize(Vec3(0.5f, 1, 0)), glm::normalize(Vec3(-0.2f, 1, 0.4f)),
                           glm::normalize(Vec3(0, 1, -0.3f))};
  const Vec3 points[] = {{0.8f, 0.1f, 0.1f},
                         {0.1f, 0.8f, 0.1f},
                         {0.1f, 0.1f, 0.8f},
                         {0.2f, 0.5f, 0.3f},
                         {0.2f, 0.3f, 0.5f}};
  for (const Vec3& b : points) {
    const glm::dvec3 n =
        glm::normalize(double{b.x} * glm::dvec3(normals[0]) + double{b.y} * glm::dvec3(normals[1]) +
                       double{b.z} * glm::dvec3(normals[2]));
    const glm::dvec3 wo = glm::normalize(glm::dvec3(0.5, 2, 0.25));
    const double expected = 0.5 * (1 + (2 * glm::dot(wo, n) * n - wo).y);
    for (const bool instance : {false, true}) {
      EXPECT_NEAR(seen_in_the_mirror(normals, b, instance).x, expected, 1e-4)
          << b.x << " " << b.y << " " << b.z << ", instance " << instance;
    }
  }
}

// As in Mitsuba: (u, v) is (b1, b2).
TEST(DefaultCoordinates, OfATextureAreBarycentric) {
  for (const Vec3& b : {Vec3(0.2f, 0.6f, 0.2f), Vec3(0.2f, 0.2f, 0.6f), Vec3(0.6f, 0.2f, 0.2f)}) {
    SceneData scene;
    scene.name = "stripes";
    Mesh mesh;
    mesh.positions = {{-1, 0, -1}, {-1, 0, 1}, {1, 0, -1}};
    mesh.triangles = {{{0, 1, 2}}};
    mesh.material = scene.add_material(make_diffuse(Color(1.0f)));
    Texture stripes;  // dark for u <= 1/2
    stripes.kind = TextureKind::checkerboard;
    stripes.color0 = Color(0.25f), stripes.color1 = Color(0.75f);
    stripes.v_row[1] = 0;
    scene.textures.push_back(stripes);
    scene.materials[0].parameters[0].texture = 0;
    const Vec3 at = b.x * mesh.positions[0] + b.y * mesh.positions[1] + b.z * mesh.positions[2];
    scene.camera = {at + Vec3(0, 2, 0), at, {0, 0, 1}, 0.001f, 0.0f, 2.0f};
    scene.meshes.push_back(mesh);
    scene.sky = {Color(1.0f), Color(1.0f)};
    EXPECT_NEAR(image_of(scene, image_options(2, 2, 4, 2)).rgb[0], b.y > 0.5f ? 0.75f : 0.25f, 1e-5)
        << b.y << " " << b.z;
  }
}

}  // namespace
}  // namespace pt
