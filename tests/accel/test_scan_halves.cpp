// Candidates in half precision, as CUDA finds them, by arithmetic of our own: none is lost, and
// few are invented.
#include <gtest/gtest.h>

#include "accel/nasty_rays.h"
#include "accel/primitive_scenes.h"
#include "common/accel/traverse_brute.h"
#include "common/scene/builtin/builtin_scenes.h"

namespace pt {
namespace {

TEST(HalfFloat, EveryHalfComesBack) {
  for (std::uint32_t bits = 0; bits < 0x10000; ++bits) {
    const double x = from_half(static_cast<std::uint16_t>(bits));
    if (!std::isnan(x)) {
      ASSERT_EQ(to_half(x), bits);
    }
  }
  EXPECT_EQ(from_half(0x3c00), 1.0);
  EXPECT_EQ(from_half(0xc100), -2.5);
  EXPECT_EQ(from_half(0x0001), 0x1p-24);
  EXPECT_EQ(to_half(NAN), 0x7fff);
}

TEST(HalfFloat, WhatLiesBetweenTwoGoesToTheNearerOrTheEvenOne) {
  for (std::uint32_t bits = 0; bits < 0x7bff; ++bits) {
    const double low = from_half(static_cast<std::uint16_t>(bits));
    const double high = from_half(static_cast<std::uint16_t>(bits + 1));
    const double middle = 0.5 * (low + high);
    ASSERT_EQ(to_half(middle), bits + bits % 2);
    ASSERT_EQ(to_half(std::nextafter(middle, 0.0)), bits);
    ASSERT_EQ(to_half(-std::nextafter(middle, 1e9)), 0x8000 + bits + 1);
  }
  EXPECT_EQ(to_half(std::nextafter(65520.0, 0.0)), 0x7bff);
  EXPECT_EQ(to_half(65520.0), 0x7c00);
}

TEST(HalfFloat, PairsAreComputedSideBySide) {
  const std::uint32_t a = pack_halves(3.0f, -0.5f), b = pack_halves(1.5f, 4.0f);
  EXPECT_EQ(multiply_add_halves(a, b, pack_halves(-4.5f, 1.0f)), pack_halves(0.0f, -1.0f));
  EXPECT_EQ(negate_halves(a), pack_halves(-3.0f, 0.5f));
  EXPECT_EQ(sign_bytes(a, b), 0x0000ff00u);
  EXPECT_EQ(sign_bytes(b, negate_halves(a)), 0x00ff0000u);
}

/// A ray from around a scene, from far away or from within a sphere; a half of them graze one.
Ray grazing_ray(TestRandom& random, const SceneData& scene) {
  const Sphere& sphere =
      scene.spheres[random.below(static_cast<std::uint32_t>(scene.spheres.size()))];
  Vec3 origin = scene.scan_center + random_point(random, random.log_uniform(0.1, 20));
  if (random.below(4) == 0) origin = scene.camera.look_from;
  if (random.below(8) == 0) origin = sphere.center;
  Vec3 direction = random_point(random, 1);
  if (random.below(2) == 0) {
    const Vec3 side = glm::cross(sphere.center - origin, direction);
    const float length = std::sqrt(glm::dot(side, side));
    if (length > 0) direction = sphere.center + (sphere.radius() / length) * side - origin;
  }
  if (!(glm::dot(direction, direction) > 1e-20f)) direction = {0, -1, 0};
  return {origin, normalize(direction)};
}

/// How often each sphere is tested.
std::vector<int> count_candidates(const Primitives& primitives, const Ray& ray) {
  std::vector<int> counts(primitives.sphere_count);
  for_each_half_sphere(primitives, ray, [&](float, std::uint32_t i) {
    ++counts.at(i);
    return false;
  });
  return counts;
}

class HalfScanOf : public testing::TestWithParam<SceneKind> {};
INSTANTIATE_TEST_SUITE_P(Kinds, HalfScanOf, testing::ValuesIn(scene_kinds),
                         [](const auto& kind) { return std::string(kind.param.name); });

TEST_P(HalfScanOf, EverySphereIsACandidateThatItsTestOrItsLineMeets) {
  for (const int count : {1, 2, 3, 5, 9, 20, 33, 51, 64, 100, 300}) {
    SCOPED_TRACE(testing::Message() << count << " primitives");
    const SceneData scene = make_random_scene(GetParam(), count);
    if (scene.spheres.empty()) continue;
    const Scene view = host_view(scene, 1, 1);
    TestRandom random(11);
    for (int i = 0; i < 400; ++i) {
      const Ray ray = grazing_ray(random, scene);
      const std::vector<int> counts = count_candidates(view.primitives, ray);
      for (std::size_t s = 0; s < counts.size(); ++s) {
        const Sphere& sphere = scene.spheres[s];
        const glm::dvec3 oc = glm::dvec3(sphere.center) - glm::dvec3(ray.origin);
        const double off = glm::length(glm::cross(oc, glm::normalize(glm::dvec3(ray.direction))));
        const bool met = off < sphere.radius() || sphere_distance(sphere, ray) > 0.0f;
        ASSERT_LE(counts[s], 1) << "sphere " << s << ", ray " << i;
        if (met) {
          ASSERT_EQ(counts[s], 1) << "sphere " << s << " lost, ray " << i;
        }
      }
    }
  }
}

TEST_P(HalfScanOf, NastyRaysMeetWhatTheyMeetByAScanInFloat) {
  const SceneData scene = make_random_scene(GetParam(), 50);
  const Primitives primitives = host_view(scene, 1, 1).primitives;
  if (scene.spheres.empty()) return;
  TestRandom random(12);
  for (int i = 0; i < 3000; ++i) {
    Ray ray = make_nasty(grazing_ray(random, scene), random);
    ray.direction = normalize(ray.direction);  // unit length, or none at all
    Hit expected, hit;
    const auto keep = [&](Hit& nearest) {
      return [&](float t, std::uint32_t primitive) {
        EXPECT_LT(primitive, primitives.sphere_count);
        keep_nearer(nearest, t, primitive);
        return false;
      };
    };
    for (std::uint32_t s = 0; s < primitives.sphere_count; ++s) {
      keep_nearer(expected, sphere_distance(primitives.spheres[s], ray), s);
    }
    for_each_half_sphere(primitives, ray, keep(hit));
    const float far = max_abs(ray.origin);
    if (far > 1e6f && far < HUGE_VALF) continue;  // its exact test is not exact
    ASSERT_EQ(hit.primitive, expected.primitive) << "ray " << i;
    ASSERT_EQ(hit.t, expected.t) << "ray " << i;
  }
}

// What a scan in half precision costs: spheres that are tested in vain.
TEST(HalfScan, NamesFewSpheresOfThePapersSceneThatTheLineMisses) {
  Options options;
  options.scene = "spheres", options.spheres = 50;
  SceneData scene = make_scene(options);
  prepare_scene(scene, options);
  const Primitives primitives = host_view(scene, 1, 1).primitives;
  TestRandom random(13);
  int met = 0, candidates = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 origin = 5.0f * random_point(random, 1) * Vec3(1, 0.05f, 1);
    const Ray ray{origin, normalize(random_point(random, 1) * Vec3(1, 0.2f, 1))};
    const std::vector<int> counts = count_candidates(primitives, ray);
    for (std::uint32_t s = 1; s < counts.size(); ++s) {  // 0 is the ground
      const Vec3 oc = primitives.spheres[s].center - ray.origin;
      met += glm::length(glm::cross(oc, ray.direction)) < primitives.spheres[s].radius();
      candidates += counts[s];
    }
    ASSERT_EQ(counts[0], 1);
  }
  EXPECT_GT(met, 15'000);
  EXPECT_LT(candidates, 1.15 * met);
}

}  // namespace
}  // namespace pt
