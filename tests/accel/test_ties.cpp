// A ray hits the lowest triangle of those at one distance, then the lowest instance: known
// without asking any structure, so that an error which all of them share is seen too.
#include <gtest/gtest.h>

#include "accel/hard_hits.h"
#include "accel/tree_kinds.h"

namespace pt {
namespace {

constexpr std::uint32_t different = 8, copies = 5;

/// make_coincident repeats the first triangles, so that no other may be met. A mesh whose copies
/// are of other materials looks different where one of them wins.
TEST(Ties, GoToTheLowestTriangle) {
  Mesh once = make_coincident(different * copies);
  const RaySet rays = hard_rays(once, 200);
  for (const std::uint32_t material : {0u, 1u}) {
    // The copies as a mesh of their own, which is numbered second.
    Mesh first = once, second = once;
    first.triangles.resize(different);
    first.material = material, second.material = 1 - material;
    second.triangles.erase(second.triangles.begin(), second.triangles.begin() + different);
    const auto expect_first = [&](const TreeKind& kind) {
      const TriangleTreeData tree = kind.build({first, second});
      int hits = 0;
      for (const RayRecord& record : rays.rays) {
        const Hit hit = closest_hit(tree, record.ray());
        if (hit.is_miss()) continue;
        ++hits;
        const Triangle& triangle = tree.triangles.at(hit.primitive);
        ASSERT_LT(triangle.id, different) << kind.name;
        ASSERT_EQ(triangle.material, material) << kind.name;
      }
      EXPECT_GT(hits, 500) << kind.name;
    };
    expect_first(brute_kind);
    for (const TreeKind& kind : tree_kinds) expect_first(kind);
  }
}

/// Every instance is there twice, one after the other.
TEST(Ties, GoToTheLowestTriangleThenTheLowestInstance) {
  Mesh mesh = make_coincident(different * copies);
  const RaySet rays = hard_rays(mesh, 200);
  mesh.group = 1;
  const std::vector<Instance> instances = hard_instances(12);
  const auto expect_first = [&](const TreeKind& kind) {
    const TriangleTreeData tree = kind.build({mesh}, instances);
    int hits = 0;
    for (std::size_t i = 0; i < rays.rays.size(); ++i) {
      const Affine& place = instances[i % instances.size()].to_world;
      const Ray ray = rays.rays[i].ray();
      const Vec3 direction = normalize(place.vector(ray.direction));
      const Hit hit = closest_hit(tree, {place.point(ray.origin), direction});
      if (hit.is_miss()) continue;
      ++hits;
      ASSERT_LT(tree.triangles.at(hit.primitive).id, different) << kind.name;
      ASSERT_EQ(tree.instances.at(hit.instance).index % 2, 0u) << kind.name;
    }
    EXPECT_GT(hits, 500) << kind.name;
  };
  expect_first(brute_kind);
  for (const TreeKind& kind : tree_kinds) expect_first(kind);
}

}  // namespace
}  // namespace pt
