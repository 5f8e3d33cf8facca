// What the tree of lights goes by: what small lamps give a place, as the law of irradiance has it,
// and the bounds of lamps, as geometry does.
#include <gtest/gtest.h>

#include "common/light/light_tree.h"
#include "common/transport/sample_light.h"
#include "scene/lamp_rooms.h"
#include "statistics.h"

namespace pt {
namespace {

/// A small square lamp, or a point without a normal.
struct SmallLamp {
  Vec3 place, normal;
  float strength;
  bool is_point;
};

/// What a small lamp gives a surface: the cosines and the inverse square of the distance. 0 where
/// it is near or seen at grazing angles, where its size or the rounding of packed cones counts.
double irradiance_of(const SmallLamp& lamp, const Vec3& from, const Vec3& normal) {
  const Vec3 way = lamp.place - from;
  const double distance = glm::length(way);
  const double sent = lamp.is_point ? 1 : -glm::dot(way, lamp.normal) / distance;
  const double received = glm::dot(way, normal) / distance;
  if (distance < 0.5 || sent < 0.3 || received < 0.05) return 0;
  return lamp.strength * sent * received / (distance * distance);
}

// Lamps that are small as seen from the receiver are chosen by exactly what they give there.
TEST(LightBounds, OfTwoSmallLampsEachHasItsShare) {
  TestRandom random(31);
  int compared = 0;
  for (int i = 0; i < 3000; ++i) {
    SceneData scene;
    std::vector<SmallLamp> lamps;
    for (int k = 0; k < 2; ++k) {
      lamps.push_back({Vec3(random.point(4)), normalize(Vec3(random.direction())),
                       static_cast<float>(random.uniform(1, 5)), k == i % 2});
      const SmallLamp& lamp = lamps.back();
      if (lamp.is_point) {
        DeltaLight light;
        light.position = lamp.place, light.intensity = Color(lamp.strength);
        scene.delta_lights.push_back(light);
        continue;
      }
      constexpr float side = 1e-3f;
      const Vec3 a = side * make_frame(lamp.normal).tangent, b = glm::cross(lamp.normal, a);
      const auto glow =
          scene.add_material(make_diffuse(Color(0.0f), Color(2 * lamp.strength / (side * side))));
      Mesh half = parallelogram({}, lamp.place, a, b, glow);
      half.triangles.pop_back();  // of an area of half of side^2
      scene.meshes.push_back(half);
    }
    if (i % 2 == 0) std::swap(lamps[0], lamps[1]);  // triangles are listed first
    Options options;
    options.light_selection = LightSelection::tree;
    prepare_scene(scene, options);
    const LightSelector& selector = host_view(scene, 8, 8).light_selector;
    const Vec3 from = Vec3(random.point(4)), normal = normalize(Vec3(random.direction()));
    const double first = irradiance_of(lamps[0], from, normal);
    const double second = irradiance_of(lamps[1], from, normal);
    if (!(std::min(first, second) > 0.02 * std::max(first, second))) continue;
    ++compared;
    const double share = selector.pmf(from, make_receiver(normal, false), 0);
    ASSERT_NEAR(share, first / (first + second), 0.015) << i;
  }
  EXPECT_GT(compared, 150);
}

TEST(LightBounds, BoundsOfASphere) {
  SceneData scene;
  const Color radiance(2, 3, 5);
  scene.add_sphere({1, -2, 3}, 0.5f, scene.add_material(make_diffuse(Color(0.0f), radiance)));
  scene.meshes.push_back(parallelogram({}, {9, 9, 9}, {1, 0, 0}, {0, 1, 0},
                                       scene.add_material(make_diffuse(Color(0.5f)))));
  prepare_scene(scene);
  const LightBounds bounds = bounds_of(scene.light_list.lights.at(0)).value();
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(bounds.box.min[i], (Vec3(1, -2, 3) - 0.5f)[i], 1e-6);
    EXPECT_NEAR(bounds.box.max[i], (Vec3(1, -2, 3) + 0.5f)[i], 1e-6);
  }
  EXPECT_NEAR(bounds.cone, pi, 1e-6);  // it shines everywhere, as a disk of its radius
  EXPECT_NEAR(bounds.intensity, luminance(radiance) * pi * 0.25f, 1e-5);
}

// The cone is the least one around all ways on which some of the picture goes.
TEST(LightBounds, BoundsOfAProjector) {
  for (const float aspect : {0.5f, 1.0f, 2.0f, -3.0f}) {
    for (const float tangent : {0.2f, 1.0f}) {
      SceneData scene;
      DeltaLight projector;
      projector.kind = LightKind::projector;
      projector.position = {1, 2, 3}, projector.direction = glm::normalize(Vec3(1, 2, -2));
      projector.intensity = {2, 1, 3};
      projector.right = make_frame(projector.direction).tangent / tangent;
      projector.aspect = aspect;
      scene.delta_lights = {projector};
      scene.meshes.push_back(parallelogram({}, {9, 9, 9}, {1, 0, 0}, {0, 1, 0},
                                           scene.add_material(make_diffuse(Color(0.5f)))));
      prepare_scene(scene);
      const Light& light = scene.light_list.lights.at(0);
      const LightBounds bounds = bounds_of(light).value();
      EXPECT_EQ(bounds.box.min, projector.position);
      EXPECT_EQ(bounds.box.max, projector.position);
      EXPECT_NEAR(bounds.intensity, luminance(projector.intensity), 1e-6);
      double widest = 0;
      TestRandom random(2);
      for (int i = 0; i < 100'000; ++i) {
        const Vec3 way = normalize(Vec3(random.direction()));
        if (light.as<ProjectorLight>().project(way).factor <= 0) continue;
        widest = std::max(widest, std::acos(double{glm::dot(way, bounds.axis)}));
      }
      EXPECT_LE(widest, bounds.cone + bounds.emission);
      EXPECT_GT(widest, 0.95 * bounds.cone) << aspect << ' ' << tangent;
    }
  }
}

}  // namespace
}  // namespace pt
