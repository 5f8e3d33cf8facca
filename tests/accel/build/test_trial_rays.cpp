// Rays that tell which of several trees is the best: where they go, and what they count.
#include <gtest/gtest.h>

#include "accel/tree_kinds.h"
#include "accel/triangle_meshes.h"
#include "common/accel/build/mesh_triangles.h"
#include "common/accel/build/try_splits.h"

namespace pt {
namespace {

struct Built {
  TriangleTreeData data;
  BuiltNodes nodes;
};

Built build(const Mesh& mesh, AccelKind accel, TreeBuilder builder = TreeBuilder::sah) {
  Built built{TreeKind{"", accel, builder}.build({mesh}), {}};
  built.nodes.bvh2 = built.data.bvh2, built.nodes.cwbvh = built.data.cwbvh;
  return built;
}

constexpr AccelKind structures[] = {AccelKind::bvh2, AccelKind::cwbvh};

/// In the plane z = 0, a small triangle at x = 0, others beside it, 10 apart.
Mesh row_of_triangles(int count) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const float x = 10.0f * static_cast<float>(i);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 1}});
    mesh.triangles.push_back({{first, first + 1, first + 2}});
  }
  return mesh;
}

TEST(TrialCost, CountsNodesAndLeavesUpToTheHit) {
  for (const AccelKind accel : structures) {
    // A leaf for each: neighbours are far away.
    const BuiltNodes nodes = build(row_of_triangles(2), accel).nodes;
    const Ray along{{-5, 0.25f, 0.25f}, {1, 0, 0}}, across{{10.5f, 0.25f, -5}, {0, 0, 1}};
    const Ray beside{{5, 0.25f, -5}, {0, 0, 1}};
    const auto cost = [&](const Ray& ray, float t) {
      const TrialRay trial{ray, t};
      return trial_cost(nodes, {&trial, 1});
    };
    EXPECT_EQ(cost(along, infinite_distance), 1 + 1.5 * 2);
    EXPECT_EQ(cost(along, 7), 1 + 1.5);
    EXPECT_EQ(cost(across, infinite_distance), 1 + 1.5);
    EXPECT_EQ(cost(beside, infinite_distance), 1);
    const TrialRay all[] = {{along, infinite_distance}, {beside, infinite_distance}};
    EXPECT_EQ(trial_cost(nodes, all), (4 + 1) / 2.0);
  }
}

TEST(TrialRays, BeginOnSurfacesAndEndWhereTheyMeetOne) {
  const Mesh mesh = make_soup(600, 12);
  const TriangleTreeData brute = brute_kind.build({mesh});
  for (const AccelKind accel : structures) {
    const Built built = build(mesh, accel);
    const Bounds& bounds = built.data.groups.front().bounds;
    const std::vector<TrialRay> rays = trial_rays(built.nodes, built.data.triangles, bounds, 300);
    ASSERT_GT(rays.size(), 100u);
    ASSERT_LE(rays.size(), 600u);
    int missing = 0;
    for (const TrialRay& trial : rays) {
      const Hit hit = closest_hit(brute, trial.ray);
      ASSERT_EQ(float_to_bits(hit.t), float_to_bits(trial.t));
      missing += hit.is_miss() ? 1 : 0;
      // Backwards they meet the surface that they have left.
      const Hit behind = closest_hit(brute, {trial.ray.origin, -trial.ray.direction});
      EXPECT_LT(behind.t, 0.01f * max_abs(bounds.max - bounds.min));
    }
    EXPECT_GT(missing, 10);
    EXPECT_LT(missing, static_cast<int>(rays.size()) - 10);
    const std::vector<TrialRay> again = trial_rays(built.nodes, built.data.triangles, bounds, 300);
    ASSERT_EQ(again.size(), rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_EQ(again[i].t, rays[i].t);
  }
}

/// The walls of [0, 1]^3.
Mesh make_room() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) mesh.positions.push_back({i & 1, i >> 1 & 1, i >> 2 & 1});
  for (const std::uint32_t axis : {1u, 2u, 4u}) {
    const std::uint32_t u = axis == 4 ? 1 : 2 * axis, v = 7 - axis - u;
    for (const std::uint32_t side : {0u, axis}) {
      mesh.triangles.push_back({{side, side + u, side + u + v}});
      mesh.triangles.push_back({{side, side + v, side + u + v}});
    }
  }
  return mesh;
}

TEST(TrialRays, StayInARoom) {
  for (const AccelKind accel : structures) {
    const Built built = build(make_room(), accel);
    const std::vector<TrialRay> rays =
        trial_rays(built.nodes, built.data.triangles, {Vec3(0), Vec3(1)}, 200);
    EXPECT_EQ(rays.size(), 400u);
    for (const TrialRay& trial : rays) EXPECT_LT(trial.t, 1.8f);
  }
}

// Each ray visits every node; all 8192 paths would take a second for each thousand triangles.
TEST(TrialRays, AreFewAmongCoincidentTriangles) {
  Mesh mesh = row_of_triangles(1);
  mesh.triangles.resize(20'000, mesh.triangles.front());
  for (const AccelKind accel : structures) {
    const Built built = build(mesh, accel);
    const auto rays = [&](double cost_max) {
      return trial_rays(built.nodes, built.data.triangles, built.data.groups.front().bounds, 512,
                        cost_max);
    };
    constexpr double most = 1e5;
    const std::size_t few = rays(most).size();
    EXPECT_LE(few, 32u);  // those of 16 paths, which cost more than that already
    const std::vector<TrialRay> all = rays(infinite_distance);
    EXPECT_GT(all.size(), 10 * few);
    EXPECT_LE(all.size(), 1024u);
    for (std::size_t i = 0; i < few; ++i) EXPECT_EQ(rays(most)[i].ray.origin, all[i].ray.origin);
  }
}

TEST(TrialRays, AreNoneWhereThereIsNothingToMeet) {
  const Built built = build(row_of_triangles(1), AccelKind::cwbvh);
  const Bounds elsewhere{{100, 100, 100}, {101, 101, 101}};
  std::vector<TrialRay> rays = trial_rays(built.nodes, built.data.triangles, elsewhere, 64);
  EXPECT_EQ(trial_cost(built.nodes, rays), 0);
}

}  // namespace
}  // namespace pt
