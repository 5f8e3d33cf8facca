// Rays that take turns on their ways through the wide tree find what each finds alone, bit for bit.
#include <gtest/gtest.h>

#include "accel/nasty_rays.h"
#include "accel/tree_kinds.h"
#include "accel/triangle_rays.h"
#include "common/accel/trace_cpu/ray_block.h"
#include "common/accel/traverse_triangles.h"

namespace pt {
namespace {

class CwbvhBlocks : public testing::TestWithParam<const TreeBlock* (*)()> {
 public:
  void SetUp() override {
    if (GetParam()() == nullptr) GTEST_SKIP() << "this processor has no such lanes";
  }
  static const TreeBlock& trees() { return *GetParam()(); }
};

INSTANTIATE_TEST_SUITE_P(Lanes, CwbvhBlocks, testing::Values(tree_block_avx2, tree_block_avx512),
                         [](const auto& lanes) { return lanes.index == 0 ? "avx2" : "avx512"; });

TEST_P(CwbvhBlocks, MeetTheSameTriangles) {
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
        trees().closest(tree, block, nullptr, hits);
        const std::uint32_t occluded = trees().any(tree, block, nullptr);
        for (std::uint32_t i = 0; i < block.count; ++i) {
          const Ray ray = block.ray(i);
          const Hit expected =
              closest_triangle<Accel::cwbvh, false>(tree, ray, 0.0f, block.t_max[i]);
          ASSERT_NO_FATAL_FAILURE(expect_hit(hits, i, expected));
          const bool any = any_triangle<Accel::cwbvh, false>(tree, ray, 0.0f, block.t_max[i]);
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

/// Goes through every other triangle that has a mask.
struct OddTriangles {
  bool hides(const Triangle& triangle, const TriangleHit&, std::uint32_t) const {
    return triangle.id % 2 != 0;
  }
};
bool hides_odd_triangles(const void* triangles, const RayBlock&, std::uint32_t,
                         std::uint32_t slot) {
  return OddTriangles().hides(static_cast<const Triangle*>(triangles)[slot], {}, 0);
}

TEST_P(CwbvhBlocks, GoThroughMasks) {
  const Mesh mesh = mesh_kinds[0].make(900);
  TriangleTreeData data = TreeKind{"cwbvh_sah", AccelKind::cwbvh, TreeBuilder::sah}.build({mesh});
  for (std::size_t i = 0; i < data.triangles.size(); i += 3) {
    data.triangles[i].attributes |= TriangleAttributes::masked;
  }
  const TriangleTree tree = data.view();
  const Target target(mesh);
  TestRandom random(3);
  const BlockMask mask = {tree.triangles, hides_odd_triangles};
  int hidden = 0;
  const auto make = [&](TestRandom& r) {
    return ray_kinds[r.below(std::size(ray_kinds))].make(target, r);
  };
  for_each_block(200, random, make, [&](RayBlock& block) {
    HitBlock hits, all_hits;
    trees().closest(tree, block, &mask, hits);
    trees().closest(tree, block, nullptr, all_hits);
    const std::uint32_t occluded = trees().any(tree, block, &mask);
    for (std::uint32_t i = 0; i < block.count; ++i) {
      MaskedQuery<ClosestTriangle, OddTriangles> closest(0.0f, block.t_max[i], {});
      traverse_cwbvh<false>(tree, block.ray(i), closest);
      ASSERT_NO_FATAL_FAILURE(expect_hit(hits, i, closest.result()));
      MaskedQuery<AnyTriangle, OddTriangles> any(0.0f, block.t_max[i], {});
      traverse_cwbvh<false>(tree, block.ray(i), any);
      ASSERT_EQ((occluded >> i & 1u) != 0, any.result()) << "ray " << i;
      hidden += hits.primitive[i] != all_hits.primitive[i] ? 1 : 0;
    }
  });
  EXPECT_GT(hidden, 50);
}

TEST_P(CwbvhBlocks, MeetNothingWhereNothingIs) {
  RayBlock block;
  for (int i = 0; i < 5; ++i) block.append({Vec3(0.0f), Vec3(0.0f, 0.0f, 1.0f)}, infinite_distance);
  HitBlock hits;
  trees().closest(TriangleTree(), block, nullptr, hits);
  for (std::uint32_t i = 0; i < block.count; ++i) EXPECT_EQ(hits.primitive[i], no_primitive);
  EXPECT_EQ(trees().any(TriangleTree(), block, nullptr), 0u);
}

}  // namespace
}  // namespace pt
