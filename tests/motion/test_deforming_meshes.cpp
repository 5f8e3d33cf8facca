// Meshes that deform: with many sets of vertices and as lights, against integrals over time in
// closed form.
#include <gtest/gtest.h>

#include "common/film/aov.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/prepare/prepare_scene.h"
#include "scene/deforming_triangles.h"
#include "scene/motion_images.h"

namespace pt {
namespace {

// To the right, half of the way back, and to the right again.
TEST(DeformingMeshes, OfManySetsAreTheirIntegralOverTime) {
  SceneData scene = band_scene();
  Mesh& mesh = scene.meshes[0];
  for (const float x : {6.0f, 3.0f, 9.0f}) {
    mesh.later_positions.push_back(mesh.positions);
    for (Vec3& p : mesh.later_positions.back()) p.x += x;
  }
  const auto expected = [](int x) {
    return (seen_part(x, 6) + seen_part(x, 3, 5, 8) + seen_part(x, 6, 5, 8)) / 3;
  };
  const Options options = motion_options(16, 1, 16384);
  expect_band_everywhere(scene, options, expected);
}

// On a square that stands, whose normals turn to the right, and then up.
TEST(DeformingMeshes, TurnTheirNormals) {
  SceneData scene = band_scene();
  Mesh& mesh = scene.meshes[0];
  const auto all = [](const Vec3& normal) { return std::vector<Vec3>(4, normal); };
  const Vec3 normals[] = {{0, 0, 1}, {0.6f, 0, 0.8f}, {0, 0.6f, 0.8f}};
  mesh.normals = all(normals[0]);
  mesh.later_normals = {all(normals[1]), all(normals[2])};
  mesh.later_positions = {mesh.positions, mesh.positions};
  glm::dvec3 expected(0.0);
  for (int i = 0; i < 2000; ++i) {
    const double at = (i + 0.5) / 1000;
    const glm::dvec3 from(normals[i / 1000]), to(normals[i / 1000 + 1]);
    expected += glm::normalize(from + (at - i / 1000) * (to - from)) / 2000.0;
  }
  Options options = motion_options(16, 1, 4096);
  options.aovs = aov_bit<aov::ShadingNormal>;
  const Image image = image_of_motion(scene, options);
  for (int channel = 0; channel < 3; ++channel)
    EXPECT_NEAR(image.layers.at(0).values.at(static_cast<std::size_t>(3 * 3 + channel)),
                expected[channel], 0.02)
        << channel;
}

TEST(DeformingMeshes, AreHeldBetweenTheirSets) {
  const SceneData scene = glowing_room();
  for (const float time : {0.0f, 0.3f, 0.5f, 0.9f, 1.0f}) {
    SceneData held = scene;
    hold_still_at(held, time);
    EXPECT_FALSE(held.deforms());
    for (const std::size_t i : {2u, 3u}) {
      const std::vector<Vec3> expected = positions_at(scene.meshes[i], double{time});
      for (std::size_t v = 0; v < 4; ++v)
        EXPECT_LT(glm::length(held.meshes[i].positions[v] - expected[v]), 1e-6f) << time;
    }
  }
  SceneData turned = glowing_room();  // halfway between its first two normals
  hold_still_at(turned, 1.0f / 6);
  const Vec3 n = normalize(Vec3(0, 0, 1) + Vec3(0.6f, 0, 0.8f));
  EXPECT_LT(glm::length(turned.meshes[3].normals[1] - n), 1e-6f);
}

/// What takes over the rise of a lamp: its vertices, in the world or in an instance that mirrors,
/// or an instance that moves.
enum class Rise { in_world, in_mirrored_instance, by_instance };

/// A white floor, of which the camera sees the origin, and a square lamp of radiance 20 that shines
/// down on it. Its centre rises from 1 to 3, and its sides grow from 0 to 2.
SceneData growing_lamp(Rise rise) {
  SceneData scene;
  scene.name = "growing lamp";
  scene.camera = {{0, 0.5f, -6}, {0, 0, 0}, {0, 1, 0}, 0.05f, 0.0f, 6.0f};
  Mesh floor = square_of(-9, 9, -9, 9, 0, scene.add_material(make_diffuse(Color(1.0f))));
  for (Vec3& p : floor.positions) p = {p.x, 0, -p.y};
  Mesh lamp = square_of(0, 0, 0, 0, 0, scene.add_material(make_diffuse(Color(0.0f), Color(20.0f))));
  const bool rises = rise != Rise::by_instance;
  for (Vec3& p : lamp.positions) p = {0, rises ? 1 : 0, 0};
  const float y = rises ? 3 : 0;
  lamp.later_positions = {{{-1, y, -1}, {1, y, -1}, {1, y, 1}, {-1, y, 1}}};
  if (rise != Rise::in_world) {
    lamp.group = 1;
    scene.instances = {{1, rises ? scale({-1, 1, 1}) : translate({0, 1, 0})}};
    if (!rises)
      scene.motion.instances = {{0, {{0.0f, translate({0, 1, 0})}, {1.0f, translate({0, 3, 0})}}}};
  }
  scene.meshes = {floor, lamp};
  return scene;
}

/// The form factor from a point to a square of half the side `s`, parallel to its plane, with the
/// centre at the height `h` above it.
double form_factor(double s, double h) {
  const double d = std::hypot(s, h);
  return 4 * (s / d) * std::atan(s / d) / pi_double;
}

TEST(DeformingMeshes, LightWhatIsBelow) {
  double expected = 0;
  for (int i = 0; i < 1000; ++i) {
    const double t = (i + 0.5) / 1000;
    expected += 20 * form_factor(t, 1 + 2 * t) / 1000;
  }
  for (const Rise rise : {Rise::in_world, Rise::in_mirrored_instance, Rise::by_instance}) {
    const SceneData scene = growing_lamp(rise);
    SceneData prepared = scene;
    prepare_scene_for(prepared, motion_options(8, 8, 1, 2), cpu_of_motion());
    EXPECT_FLOAT_EQ(prepared.light_list.total_weight, 20 * 2);  // of no size when it begins
    const auto expect_mean = [&](const Options& options, double tolerance, const char* what) {
      double sum = 0;
      const Image image = image_of_motion(scene, options);
      for (const float value : image.rgb) sum += double{value};
      EXPECT_NEAR(sum / static_cast<double>(image.rgb.size()), expected, tolerance * expected)
          << what << ", " << static_cast<int>(rise);
    };
    Options options = motion_options(8, 8, 1024, 2);
    expect_mean(options, 0.005, "power heuristic");
    options.light_selection = LightSelection::tree;
    expect_mean(options, 0.005, "light tree");
    options.mis = MisHeuristic::balance, options.light_selection = LightSelection::uniform;
    expect_mean(options, 0.005, "balance heuristic");
    options.nee = false, options.spp = 16384;
    expect_mean(options, 0.01, "without light sampling");
  }
}

TEST(DeformingMeshes, HaveTheirBacksBehindThemAllTheTime) {
  Mesh mesh = square_of(0, 1, 0, 1, 0, 0), end = square_of(2, 5, 1, 3, 4, 0);
  mesh.normals = std::vector<Vec3>(4, Vec3(0, 0, 1)), end.normals = mesh.normals;
  end.normals[1] = {0, 0.6f, 0.8f};
  const Mesh back = back_of(mesh), end_back = back_of(end);
  mesh.later_positions = {end.positions}, mesh.later_normals = {end.normals};
  EXPECT_EQ(back_of(mesh).positions, back.positions);
  EXPECT_EQ(back_of(mesh).later_positions.at(0), end_back.positions);
  EXPECT_EQ(back_of(mesh).later_normals.at(0), end_back.normals);
  for (const Vec3& p : end_back.positions) EXPECT_LT(p.z, 4.0f);
}

}  // namespace
}  // namespace pt
