// Whatever a scene is made of, a block of rays meets what each of its rays meets alone.
#include <gtest/gtest.h>

#include "accel/nasty_rays.h"
#include "accel/primitive_scenes.h"
#include "common/accel/traverse_triangles.h"
#include "common/transport/intersect.h"
#include "common/transport/intersect_block.h"
#include "scene/masked_room.h"
#include "scene/mixed_scene.h"
#include "scene/small_scenes.h"

namespace pt {
namespace {

/// Rays from everywhere in and around the scene's camera's view.
template <class T>
void expect_same_hits(SceneData& scene, AccelKind accel) {
  Options options;
  options.accel = accel;
  prepare_scene(scene, options);
  const Scene view = host_view(scene, 32, 32);
  const BlockTraits traits = {T::accel, T::geometry, T::has_masks};
  TestRandom random(5);
  const Vec3 center = scene.camera.look_at;
  const double size = glm::length(scene.camera.look_from - center);
  const auto make = [&](TestRandom& r) {
    const Vec3 from = center + random_point(r, size), to = center + random_point(r, 0.4 * size);
    return Ray{from, normalize(to - from)};
  };
  int hits_found = 0, occluded_found = 0;
  for_each_block(200, random, make, [&](const RayBlock& block) {
    RayBlock far = block, near = block;
    for (std::uint32_t i = 0; i < block.count; ++i) {
      far.key[i] = near.key[i] = 7 * i;
      far.t_max[i] = infinite_distance;
    }
    Hit hits[RayBlock::size_max];
    intersect_closest_block(traits, view, far, hits);
    const std::uint32_t occluded = intersect_shadow_block(traits, view, near);
    for (std::uint32_t i = 0; i < block.count; ++i) {
      const Hit expected = intersect_closest<T>(view, block.ray(i), 7 * i);
      ASSERT_EQ(hits[i].primitive, expected.primitive) << "ray " << i;
      ASSERT_EQ(float_to_bits(hits[i].t), float_to_bits(expected.t)) << "ray " << i;
      ASSERT_EQ(hits[i].instance, expected.instance) << "ray " << i;
      const bool any = intersect_shadow<T>(view, {block.ray(i), block.t_max[i]}, 7 * i);
      ASSERT_EQ((occluded >> i & 1u) != 0, any) << "ray " << i;
      hits_found += expected.is_miss() ? 0 : 1, occluded_found += any ? 1 : 0;
    }
  });
  EXPECT_GT(hits_found, 300);
  EXPECT_GT(occluded_found, 200);
}

template <Accel accel, Geometry geometry>
using Rays = Traits<accel, geometry, Lighting::sky>;

TEST(IntersectBlock, MeetsTheSameSpheresAndQuads) {
  SceneData scene = make_random_scene(scene_kinds[2], 40);
  expect_same_hits<Rays<Accel::brute, Geometry::spheres_and_quads>>(scene, AccelKind::brute);
}

/// A scene of triangles and spheres, whose rays meet both.
SceneData triangles_and_spheres() {
  SceneData scene = mixed_scene();
  scene.instances.clear();
  return scene;
}

TEST(IntersectBlock, MeetsTheSameByBruteForce) {
  SceneData one_level = triangles_and_spheres(), instances = mixed_scene();
  expect_same_hits<Rays<Accel::brute, Geometry::mixed>>(one_level, AccelKind::brute);
  expect_same_hits<Rays<Accel::brute, Geometry::mixed>>(instances, AccelKind::brute);
}

TEST(IntersectBlock, MeetsTheSameByTheWideTree) {
  if (!has_avx2()) GTEST_SKIP() << "this processor has no AVX2";
  SceneData one_level = triangles_and_spheres(), instances = mixed_scene();
  expect_same_hits<Rays<Accel::cwbvh_avx2, Geometry::mixed>>(one_level, AccelKind::cwbvh);
  expect_same_hits<Rays<Accel::cwbvh_avx2, Geometry::mixed>>(instances, AccelKind::cwbvh);
}

TEST(IntersectBlock, MeetsTheSameThroughMasks) {
  SceneData scene = masked_room();
  expect_same_hits<MaskedRays>(scene, AccelKind::cwbvh);
}

}  // namespace
}  // namespace pt
