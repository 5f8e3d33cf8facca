// What AVX2 does at once is what the plain tests do one after the other, bit for bit: in nodes, in
// triangles, in whole traversals. So the plain ones are tested wherever the others are.
#include <gtest/gtest.h>

#include "accel/tree_kinds.h"
#include "accel/triangle_rays.h"
#include "common/accel/trace_cpu/traverse_cwbvh_avx2.h"
#include "common/accel/traverse_triangles.h"

namespace pt {
namespace {

#ifdef __x86_64__

class CwbvhAvx2 : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_avx2()) GTEST_SKIP() << "this processor has no AVX2";
  }
};

/// Calls function(tree, ray, random) for rays of all kinds in meshes of all kinds.
template <class Function>
void for_each_ray(Function&& function) {
  const TreeKind wide = {"cwbvh_sah", AccelKind::cwbvh, TreeBuilder::sah};
  for (const MeshKind& mesh_kind : mesh_kinds) {
    for (const int count : {1, 60, 900}) {
      const Mesh mesh = mesh_kind.make(count);
      const TriangleTreeData tree = wide.build({mesh});
      const Target target(mesh);
      TestRandom random(31);
      for (const RayKind& ray_kind : ray_kinds) {
        SCOPED_TRACE(testing::Message() << mesh_kind.name << ' ' << count << ' ' << ray_kind.name);
        for (int i = 0; i < 50; ++i) function(tree, ray_kind.make(target, random), random);
      }
    }
  }
}

TEST_F(CwbvhAvx2, PassesTheSameBoxes) {
  int passed = 0, tested = 0;
  for_each_ray([&](const TriangleTreeData& tree, const Ray& ray, TestRandom& random) {
    if (!is_traceable(ray)) return;
    const CwbvhRay wide_ray = make_cwbvh_ray(ray);
    for (const float t_max : {infinite_distance, 10.0f * static_cast<float>(random.unit())}) {
      const CwbvhNode& node =
          tree.cwbvh[random.below(static_cast<std::uint32_t>(tree.cwbvh.size()))];
      const std::uint32_t slots = intersect_cwbvh_node(node, wide_ray, 0.0f, t_max);
      EXPECT_EQ(intersect_cwbvh_node_avx2(node, wide_ray, 0.0f, t_max), slots);
      passed += count_bits(slots), tested += count_bits(node.used_mask());
    }
  });
  EXPECT_GT(passed, tested / 20);
  EXPECT_LT(passed, tested / 2);
}

TEST_F(CwbvhAvx2, MeetsTheSameTriangles) {
  int met = 0;
  for_each_ray([&](const TriangleTreeData& tree, const Ray& ray, TestRandom& random) {
    if (!is_traceable(ray)) return;
    const TriangleRay triangle_ray = make_triangle_ray(ray.origin, ray.direction);
    const auto count = static_cast<std::uint32_t>(tree.triangles.size());
    std::uint32_t slots[4];
    for (std::uint32_t& slot : slots) slot = random.below(count);
    const Triangle& first = tree.triangles[slots[0]];
    const float t0 = intersect_triangle(triangle_ray, first.v0, first.v1, first.v2).t;
    for (const float t_max : {infinite_distance, t0}) {  // t0: a hit at the very end counts
      float t[4];
      const std::uint32_t hits =
          intersect_triangles_avx2(triangle_ray, tree.triangles.data(), slots, 0.0f, t_max, t);
      for (std::uint32_t k = 0; k < 4; ++k) {
        const Triangle& triangle = tree.triangles[slots[k]];
        const TriangleHit hit =
            intersect_triangle(triangle_ray, triangle.v0, triangle.v1, triangle.v2);
        const bool expected = hit.t > 0.0f && hit.t <= t_max;
        ASSERT_EQ(hits >> k & 1u, expected ? 1u : 0u) << k << ", t " << hit.t;
        if (expected) {
          EXPECT_EQ(t[k], hit.t) << k;
          ++met;
        }
      }
    }
  });
  EXPECT_GT(met, 1000);
}

TEST_F(CwbvhAvx2, TraversalsEndAlike) {
  int hits = 0;
  for_each_ray([&](const TriangleTreeData& data, const Ray& ray, TestRandom&) {
    const TriangleTree tree = data.view();
    ClosestTriangle plain(0.0f, infinite_distance), avx2 = plain;
    traverse_cwbvh_by<false, CwbvhTests>(tree, ray, plain);
    traverse_cwbvh_avx2<false>(tree, ray, avx2);
    const Hit a = plain.result(), b = avx2.result();
    EXPECT_EQ(a.t, b.t);
    EXPECT_EQ(a.primitive, b.primitive);
    AnyTriangle plain_any(0.0f, a.t),
        avx2_any = plain_any;  // what lies before the closest: nothing
    traverse_cwbvh_by<false, CwbvhTests>(tree, ray, plain_any);
    traverse_cwbvh_avx2<false>(tree, ray, avx2_any);
    EXPECT_EQ(plain_any.result(), avx2_any.result());
    hits += a.is_miss() ? 0 : 1;
  });
  EXPECT_GT(hits, 1000);
}

#endif

}  // namespace
}  // namespace pt
