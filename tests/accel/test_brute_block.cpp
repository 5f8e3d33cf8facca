// What lanes test at once is what the plain loops find one ray after the other, bit for bit.
#include <gtest/gtest.h>

#include "accel/nasty_rays.h"
#include "accel/primitive_scenes.h"
#include "accel/tree_kinds.h"
#include "accel/triangle_rays.h"
#include "common/accel/trace_cpu/ray_block.h"
#include "common/accel/traverse_brute.h"
#include "common/accel/traverse_triangles.h"

namespace pt {
namespace {

struct LaneKind {
  const char* name;
  const BruteBlock* (*block)();
};
void PrintTo(const LaneKind& kind, std::ostream* out) { *out << kind.name; }

class BruteBlocks : public testing::TestWithParam<LaneKind> {
 protected:
  void SetUp() override {
    lanes_ = GetParam().block();
    if (lanes_ == nullptr) GTEST_SKIP() << "this processor has no " << GetParam().name;
  }
  const BruteBlock* lanes_ = nullptr;
};
INSTANTIATE_TEST_SUITE_P(By, BruteBlocks,
                         testing::Values(LaneKind{"avx2", brute_block_avx2},
                                         LaneKind{"avx512", brute_block_avx512}),
                         [](const auto& kind) { return std::string(kind.param.name); });

TEST_P(BruteBlocks, MeetTheSameSpheresAndQuads) {
  int hits_found = 0, occluded_found = 0;
  for (const SceneKind& kind : scene_kinds) {
    for (const int count : {1, 9, 70}) {
      SCOPED_TRACE(testing::Message() << kind.name << ' ' << count);
      SceneData scene;
      scene.add_material(MaterialDescription());
      TestRandom random(static_cast<std::uint64_t>(count));
      kind.fill(scene, random, count);
      Options options;
      options.accel = AccelKind::brute;
      prepare_scene(scene, options);
      const Primitives primitives = host_view(scene, 8, 8).primitives;
      const auto make = [&](TestRandom& r) {
        const Vec3 around = random_point(r, 12) + (r.below(8) == 0 ? far_away : Vec3(0.0f));
        if (r.below(4) == 0) return axis_ray(around, r, 20.0f);
        return ray_to(around, random_point(r, 10));
      };
      for_each_block(64, random, make, [&](RayBlock& block) {
        RayBlock far = block;
        std::fill_n(far.t_max, far.count, infinite_distance);
        far.fill_lanes(), block.fill_lanes();
        HitBlock hits;
        lanes_->closest_primitives(primitives, far, hits);
        const std::uint32_t occluded = lanes_->any_primitive(primitives, block);
        for (std::uint32_t i = 0; i < block.count; ++i) {
          const Hit expected = closest_hit_brute(primitives, block.ray(i));
          ASSERT_NO_FATAL_FAILURE(expect_hit(hits, i, expected));
          const bool any = any_hit_brute(primitives, block.ray(i), block.t_max[i]);
          ASSERT_EQ((occluded >> i & 1u) != 0, any) << "ray " << i;
          hits_found += expected.is_miss() ? 0 : 1, occluded_found += any ? 1 : 0;
        }
      });
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(hits_found, 1500);
  EXPECT_GT(occluded_found, 1000);
}

TEST_P(BruteBlocks, MeetTheSameTriangles) {
  int hits_found = 0, occluded_found = 0;
  for (const MeshKind& mesh_kind : mesh_kinds) {
    for (const int count : {1, 60}) {
      const Mesh mesh = mesh_kind.make(count);
      const TriangleTreeData data = brute_kind.build({mesh});
      const TriangleTree tree = data.view();
      const Target target(mesh);
      TestRandom random(31);
      for (const RayKind& ray_kind : ray_kinds) {
        SCOPED_TRACE(testing::Message() << mesh_kind.name << ' ' << count << ' ' << ray_kind.name);
        const auto make = [&](TestRandom& r) { return ray_kind.make(target, r); };
        for_each_block(8, random, make, [&](RayBlock& block) {
          // Some rays end exactly where they meet something, or the next float before or behind.
          for (std::uint32_t i = 0; i < block.count; i += 3) {
            const float t =
                closest_triangle<Accel::brute, false>(tree, block.ray(i), 0.0f, HUGE_VALF).t;
            block.t_max[i] = random.below(2) == 0 ? t : std::nextafter(t, HUGE_VALF);
          }
          block.fill_lanes();
          HitBlock hits;
          lanes_->closest_triangles(tree, block, hits);
          const std::uint32_t occluded = lanes_->any_triangle(tree, block);
          for (std::uint32_t i = 0; i < block.count; ++i) {
            const Ray ray = block.ray(i);
            const Hit expected =
                closest_triangle<Accel::brute, false>(tree, ray, 0.0f, block.t_max[i]);
            ASSERT_NO_FATAL_FAILURE(expect_hit(hits, i, expected));
            const bool any = any_triangle<Accel::brute, false>(tree, ray, 0.0f, block.t_max[i]);
            ASSERT_EQ((occluded >> i & 1u) != 0, any) << "ray " << i;
            hits_found += expected.is_miss() ? 0 : 1, occluded_found += any ? 1 : 0;
          }
        });
        if (HasFatalFailure()) return;
      }
    }
  }
  EXPECT_GT(hits_found, 1500);
  EXPECT_GT(occluded_found, 1000);
}

}  // namespace
}  // namespace pt
