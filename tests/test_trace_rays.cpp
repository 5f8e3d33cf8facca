// Tracing sets of rays: every structure and every device gives the same hits, also those that an
// independent tracer found.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>

#include "common/accel/build_triangle_tree.h"
#include "common/scene/generate_terrain.h"
#include "common/trace/compare_hits.h"
#include "common/trace/generate_rays.h"
#include "common/trace/trace_rays.h"
#include "instanced_meshes.h"
#include "shared_file.h"

namespace pt {
namespace {

TriangleTreeData tree_over(const Mesh& mesh, AccelKind accel,
                           TreeBuilder builder = TreeBuilder::sah) {
  TreeOptions options;
  options.accel = accel;
  options.builder = builder;
  return build_triangle_tree({&mesh, 1}, {}, options);
}

Camera terrain_camera(int size) {
  CameraParameters camera;
  camera.look_from = {-490, 175, 490};
  camera.look_at = {0, 10, 0};
  return make_camera(camera, size, size);
}

RaySet terrain_rays(const TriangleTreeData& tree, RayKind kind, int size) {
  return generate_rays(kind, tree, terrain_camera(size), size,
                       scale_ray_kinds(tree.groups.front().bounds));
}

TEST(TraceRays, StructuresAgree) {
  const Mesh mesh = generate_terrain(3000);
  const TriangleTreeData wide = tree_over(mesh, AccelKind::cwbvh);
  for (const RayKind kind : {RayKind::primary, RayKind::ao, RayKind::diffuse}) {
    const RaySet rays = terrain_rays(wide, kind, 32);
    ASSERT_GT(rays.rays.size(), 100u);
    const auto expected = trace_rays_cpu(tree_over(mesh, AccelKind::brute), rays, {}).hits;
    for (const AccelKind accel : {AccelKind::bvh2, AccelKind::cwbvh}) {
      for (const TreeBuilder builder : {TreeBuilder::sah, TreeBuilder::sbvh}) {
        const auto hits = trace_rays_cpu(tree_over(mesh, accel, builder), rays, {}).hits;
        const HitComparison comparison = compare_hits(hits, expected);
        EXPECT_EQ(comparison.same, rays.rays.size()) << comparison.first;
      }
    }
  }
}

TEST(TraceRays, StructuresAgreeOnInstances) {
  for (const std::uint32_t groups : {1u, 60u}) {
    const InstancedMeshes world = make_instanced_meshes(groups);
    const RaySet rays = rays_through(4000, RayType::closest);
    const auto hits_of = [&](AccelKind accel) {
      TreeOptions options;
      options.accel = accel;
      const auto tree = build_triangle_tree(world.meshes, world.instances, options);
      return trace_rays_cpu(tree, rays, {}).hits;
    };
    const auto expected = hits_of(AccelKind::brute);
    std::size_t met = 0;
    for (const HitRecord& hit : expected) met += hit.t >= 0;
    EXPECT_GT(met, rays.rays.size() / 20);
    for (const AccelKind accel : {AccelKind::bvh2, AccelKind::cwbvh}) {
      const auto hits = hits_of(accel);
      EXPECT_EQ(std::memcmp(hits.data(), expected.data(), hits.size() * sizeof(HitRecord)), 0);
    }
  }
}

TEST(TraceRays, ComparisonTellsWhatDiffers) {
  const std::vector<HitRecord> expected = {
      {1, 5}, {1, 5}, {1, 5}, {-1, no_primitive}, {1, 5}, {-1, no_primitive}};
  const std::vector<HitRecord> hits = {{1.000001f, 5},     {1, 6}, {1.001f, 5}, {-1, no_primitive},
                                       {-1, no_primitive}, {2, 3}};
  const HitComparison c = compare_hits(hits, expected);
  EXPECT_EQ(c.same, 2u);
  EXPECT_EQ(c.ties, 1u);
  EXPECT_EQ(c.other, 1u);
  EXPECT_EQ(c.missed, 1u);
  EXPECT_EQ(c.invented, 1u);
  EXPECT_FALSE(c.agrees());
  EXPECT_EQ(c.first.substr(0, 6), "ray 2:");
}

/// Ambient occlusion rays leave the surface on the side that the camera sees.
TEST(TraceRays, RaySetsAreWhatTheySay) {
  const Mesh mesh = generate_terrain(3000);
  const TriangleTreeData tree = tree_over(mesh, AccelKind::cwbvh);
  const RaySet primary = terrain_rays(tree, RayKind::primary, 32);
  EXPECT_EQ(primary.rays.size(), 1024u);
  EXPECT_EQ(primary.type, RayType::closest);
  const auto hits = trace_rays_cpu(tree, primary, {}).hits;
  std::size_t hit_count = 0;
  for (const HitRecord& hit : hits) hit_count += hit.t >= 0;
  const RaySet ao = terrain_rays(tree, RayKind::ao, 32);
  EXPECT_EQ(ao.type, RayType::any);
  EXPECT_EQ(ao.rays.size(), 8 * hit_count);
  for (const RayRecord& ray : ao.rays) EXPECT_NEAR(glm::length(ray.direction), 1.0f, 1e-5f);
}

class TraceVectors : public testing::TestWithParam<const char*> {};

TEST_P(TraceVectors, AgreeWithAnIndependentTracer) {
  const std::string mesh_path = shared_file("trace/bunny_room.mesh");
  if (!std::filesystem::exists(mesh_path)) GTEST_SKIP() << "no " << mesh_path;
  const std::string name = shared_file(std::string("trace/bunny_room.") + GetParam());
  const Mesh mesh = read_trace_mesh(mesh_path);
  const RaySet rays = read_rays(name + ".rays");
  const HitSet reference = read_hits(name + ".hits");
  for (const AccelKind accel : {AccelKind::bvh2, AccelKind::cwbvh}) {
    const auto hits = trace_rays_cpu(tree_over(mesh, accel), rays, {}).hits;
    const HitComparison comparison = compare_hits(hits, reference.hits);
    EXPECT_TRUE(comparison.agrees()) << comparison.first;
    EXPECT_GT(comparison.same, 4090u);
  }
}

INSTANTIATE_TEST_SUITE_P(BunnyRoom, TraceVectors, testing::Values("primary", "diffuse"));

}  // namespace
}  // namespace pt
