// Rays that take turns on their ways through the wide tree find what each finds alone, bit for bit.
#include <gtest/gtest.h>

#include "common/accel/traverse_cwbvh_block.h"
#include "common/accel/traverse_triangles.h"
#include "nasty_rays.h"
#include "tree_kinds.h"
#include "triangle_rays.h"

namespace pt {
namespace {

TEST(CwbvhBlocks, MeetTheSameTriangles) {
  if (!has_avx2()) GTEST_SKIP() << "this processor has no AVX2";
  const TreeKind wide = {"cwbvh_sah", AccelKind::cwbvh, TreeBuilder::sah};
  int hits_found = 0, occluded_found = 0;
  for (const MeshKind& mesh_kind : mesh_kinds) {
    for (const int count : {1, 60, 900}) {
      const Mesh mesh = mesh_kind.make(count);
      const TriangleTreeData data = wide.build({mesh});
      const TriangleTree tree = data.view();
      const Target target(mesh);
      TestRandom random(17);
      SCOPED_TRACE(testing::Message() << mesh_kind.name << ' ' << count);
      const auto make = [&](TestRandom& r) {
        return ray_kinds[r.below(std::size(ray_kinds))].make(target, r);
      };
      for_each_block(64, random, make, [&](RayBlock& block) {
        HitBlock hits;
        closest_triangles_in_turns(tree, block, hits);
        const std::uint32_t occluded = any_triangles_in_turns(tree, block);
        for (std::uint32_t i = 0; i < block.count; ++i) {
          const Ray ray = block.ray(i);
          const Hit expected = closest_triangle_cwbvh<false>(tree, ray, 0.0f, block.t_max[i]);
          ASSERT_NO_FATAL_FAILURE(expect_hit(hits, i, expected));
          const bool any = any_triangle_cwbvh<false>(tree, ray, 0.0f, block.t_max[i]);
          ASSERT_EQ((occluded >> i & 1u) != 0, any) << "ray " << i;
          hits_found += expected.is_miss() ? 0 : 1, occluded_found += any ? 1 : 0;
        }
      });
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(hits_found, 3000);
  EXPECT_GT(occluded_found, 2000);
}

TEST(CwbvhBlocks, MeetNothingWhereNothingIs) {
  if (!has_avx2()) GTEST_SKIP() << "this processor has no AVX2";
  RayBlock block;
  for (int i = 0; i < 5; ++i) block.append({Vec3(0.0f), Vec3(0.0f, 0.0f, 1.0f)}, infinite_distance);
  HitBlock hits;
  closest_triangles_in_turns(TriangleTree(), block, hits);
  for (std::uint32_t i = 0; i < block.count; ++i) EXPECT_EQ(hits.primitive[i], no_primitive);
  EXPECT_EQ(any_triangles_in_turns(TriangleTree(), block), 0u);
}

}  // namespace
}  // namespace pt
