// The built-in scenes: what is in them, that they are the same every time, and that preparing them
// for a tree moves primitives, materials and lights together.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "common/scene/builtin/builtin_scenes.h"
#include "common/scene/prepare/prepare_scene.h"
#include "scene/small_scenes.h"
#include "temp_folder.h"

namespace pt {
namespace {

Options scene_options(const std::string& name, AccelKind accel = AccelKind::automatic) {
  Options options;
  options.scene = name;
  options.accel = accel;
  return options;
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

TEST(Scenes, AreTheSameEveryTime) {
  for (const std::string& name : small_scenes()) {
    SCOPED_TRACE(name);
    const SceneData a = make_scene(scene_options(name)), b = make_scene(scene_options(name));
    EXPECT_EQ(a.name, name);
    EXPECT_GT(a.primitive_count() + a.triangle_count(), 0u);
    EXPECT_TRUE(same_bytes(a.tree.triangles, b.tree.triangles));
    EXPECT_TRUE(same_bytes(a.tree.cwbvh, b.tree.cwbvh));
    EXPECT_TRUE(same_bytes(a.spheres, b.spheres) && same_bytes(a.quads, b.quads));
    EXPECT_EQ(a.material_of, b.material_of);
    EXPECT_EQ(a.lights, b.lights);
  }
}

TEST(Scenes, AreDescribed) {
  for (const SceneInfo& info : scene_list()) {
    EXPECT_FALSE(info.name.empty() || info.description.empty());
    EXPECT_EQ(info.name.find(':'), std::string::npos);
    EXPECT_EQ(info.usage().find(info.name), 0u);
  }
}

TEST(Scenes, SphereCounts) {
  for (const int count : {0, 1, 7, 50, 1000}) {
    Options options = scene_options("spheres");
    options.spheres = count;
    EXPECT_EQ(make_scene(options).spheres.size(), static_cast<std::size_t>(count) + 1);
  }
  const std::size_t rtow = make_scene(scene_options("rtow")).spheres.size();
  EXPECT_GE(rtow, 480u);  // of 22 x 22 + 4, less those in the way of the metal sphere
  EXPECT_LE(rtow, 488u);
}

// More spheres leave those that were there as they are, apart from the area over which they spread.
TEST(Scenes, ASpheresLookDoesNotDependOnTheOthers) {
  Options few = scene_options("spheres", AccelKind::brute), many = few;
  few.spheres = 10, many.spheres = 40;
  const SceneData a = make_scene(few), b = make_scene(many);
  for (std::size_t i = 0; i <= 10; ++i) {
    EXPECT_EQ(a.spheres[i].radius_squared, b.spheres[i].radius_squared);
    EXPECT_EQ(a.materials[a.material_of[i]].color(0), b.materials[b.material_of[i]].color(0));
  }
}

bool finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

TEST(Scenes, ValuesArePhysical) {
  for (const std::string& name : small_scenes()) {
    SCOPED_TRACE(name);
    const SceneData scene = make_scene(scene_options(name));
    for (const Sphere& s : scene.spheres) {
      EXPECT_TRUE(finite(s.center) && std::isfinite(s.radius_squared) && s.radius_squared > 0);
    }
    for (const Quad& q : scene.quads) {
      EXPECT_TRUE(finite(q.corner) && finite(q.dual_a) && finite(q.dual_b) && q.area > 0);
      EXPECT_NEAR(glm::length(q.normal), 1, 1e-6);
      EXPECT_NEAR(glm::dot(q.dual_a, q.edge_a), 1, 1e-5);
      EXPECT_NEAR(glm::dot(q.dual_b, q.edge_a), 0, 1e-5);
      EXPECT_NEAR(glm::dot(q.dual_b, q.edge_b), 1, 1e-5);
    }
    for (const MaterialDescription& m : scene.materials) {
      EXPECT_TRUE(finite(m.color(0)) && finite(m.emission.radiance) && std::isfinite(m.scalar(1)));
      for (int c = 0; c < 3; ++c) {
        EXPECT_TRUE(m.color(0)[c] >= 0 && m.color(0)[c] <= 1 && m.emission.radiance[c] >= 0);
      }
      EXPECT_TRUE(m.kind != kind_of<Metal> || (m.scalar(1) >= 0 && m.scalar(1) <= 1));
      EXPECT_TRUE(m.kind != kind_of<Dielectric> || m.scalar(1) > 0);
    }
  }
}

TEST(Scenes, SpheresStandOnTheGround) {
  for (const char* name : {"spheres", "rtow"}) {
    SCOPED_TRACE(name);
    Options options = scene_options(name, AccelKind::brute);
    options.spheres = 400;
    const SceneData scene = make_scene(options);
    const Sphere ground = scene.spheres[0];
    EXPECT_EQ(ground.radius(), ground_radius);
    for (std::size_t i = 1; i < scene.spheres.size(); ++i) {
      const glm::dvec3 to_ground = glm::dvec3(scene.spheres[i].center) - glm::dvec3(ground.center);
      const double radius = scene.spheres[i].radius();
      const double gap = glm::length(to_ground) - ground_radius - radius;
      EXPECT_GE(gap, -0.01 * radius) << "sphere " << i << " sinks in";
      // The book's are at one height above a ground that curves away.
      EXPECT_LE(gap, std::string(name) == "rtow" ? 0.15 : 0.01 * radius)
          << "sphere " << i << " floats";
    }
  }
}

/// Everything about a primitive but its number, for finding it again.
std::array<float, 7> fingerprint(const SceneData& scene, std::size_t i) {
  if (i < scene.spheres.size()) {
    const Sphere& s = scene.spheres[i];
    return {s.center.x, s.center.y, s.center.z, s.radius_squared, 0, 0, 0};
  }
  const Quad& q = scene.quads[i - scene.spheres.size()];
  return {q.corner.x, q.corner.y, q.corner.z, q.area, q.normal.x, q.normal.y, q.normal.z};
}

using Primitive = std::pair<std::array<float, 7>, std::array<float, 8>>;

Primitive describe(const SceneData& scene, std::size_t i) {
  const MaterialDescription& m = scene.materials[scene.material_of[i]];
  return {fingerprint(scene, i),
          {m.color(0).x, m.color(0).y, m.color(0).z, m.scalar(1), m.emission.radiance.x,
           m.emission.radiance.y, m.emission.radiance.z, static_cast<float>(m.kind)}};
}

std::vector<Primitive> describe_all(const SceneData& scene) {
  std::vector<Primitive> all;
  for (std::size_t i = 0; i < scene.primitive_count(); ++i) all.push_back(describe(scene, i));
  std::sort(all.begin(), all.end());
  return all;
}

TEST(Scenes, ATreeKeepsMaterialsAndLightsWithTheirPrimitives) {
  for (const std::string& name : primitive_scenes()) {
    SCOPED_TRACE(name);
    const SceneData brute = make_scene(scene_options(name, AccelKind::brute));
    const SceneData tree = make_scene(scene_options(name, AccelKind::bvh2));
    EXPECT_TRUE(brute.bvh_nodes.empty());
    EXPECT_FALSE(tree.bvh_nodes.empty());
    EXPECT_EQ(tree.traits.accel, Accel::bvh2);
    EXPECT_EQ(tree.material_of.size(), tree.primitive_count());
    EXPECT_EQ(describe_all(tree), describe_all(brute));
    ASSERT_EQ(tree.lights.size(), brute.lights.size());
    for (std::size_t i = 0; i < tree.lights.size(); ++i) {  // in the same order, for the same image
      EXPECT_EQ(describe(tree, tree.lights[i]), describe(brute, brute.lights[i]));
    }
  }
}

TEST(Scenes, LightsAreThePrimitivesThatEmit) {
  for (const std::string& name : primitive_scenes()) {
    for (const AccelKind accel : {AccelKind::brute, AccelKind::bvh2}) {
      const SceneData scene = make_scene(scene_options(name, accel));
      std::vector<std::uint32_t> lights = scene.lights, emitting;
      std::sort(lights.begin(), lights.end());
      for (std::uint32_t i = 0; i < scene.primitive_count(); ++i) {
        if (!is_black(scene.materials[scene.material_of[i]].emission.radiance))
          emitting.push_back(i);
      }
      EXPECT_EQ(lights, emitting) << name;
    }
  }
}

TEST(Scenes, Errors) {
  expect_error([] { make_scene(scene_options("nowhere")); }, "nowhere");
  expect_error([] { make_scene(scene_options("nowhere")); },
               "spheres, rtow, cornell, furnace, ajar, caustic");
  SceneData empty;
  empty.name = "void";
  expect_error([&] { prepare_scene(empty); }, "scene 'void' is empty");
  const SphereWorldCreator creator = [](SphereWorld&, SphereWorldKind, std::uint32_t) {};
  expect_error([&] { make_scene(scene_options("cornell"), creator); }, "--create-world");
  expect_error([&] { make_scene(scene_options("spheres"), creator); }, "is empty");
}

}  // namespace
}  // namespace pt
