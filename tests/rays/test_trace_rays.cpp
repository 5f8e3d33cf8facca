// Tracing sets of rays: every structure and every device gives the same hits, also those that an
// independent tracer found.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>

#include "accel/instanced_meshes.h"
#include "accel/terrain_rays.h"
#include "common/accel/build/build_triangle_tree.h"
#include "common/rays/trace_rays.h"
#include "common/scene/builtin/generated_scenes.h"
#include "shared_file.h"
#include "temp_folder.h"

namespace pt {
namespace {

TriangleTreeData tree_over(const Mesh& mesh, AccelKind accel,
                           TreeBuilder builder = TreeBuilder::sah) {
  TreeOptions options;
  options.accel = accel;
  options.builder = builder;
  return build_triangle_tree({&mesh, 1}, {}, options);
}

TEST(TraceRays, StructuresAgree) {
  const Mesh mesh = generate_terrain(3000);
  for (const RayKind kind : {RayKind::primary, RayKind::ao, RayKind::diffuse}) {
    const RaySet rays = terrain_rays(mesh, kind, 32);
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
  const RaySet primary = terrain_rays(mesh, RayKind::primary, 32);
  EXPECT_EQ(primary.rays.size(), 1024u);
  EXPECT_EQ(primary.type, RayType::closest);
  const auto hits = trace_rays_cpu(tree, primary, {}).hits;
  std::size_t hit_count = 0;
  for (const HitRecord& hit : hits) hit_count += hit.t >= 0;
  const RaySet ao = terrain_rays(mesh, RayKind::ao, 32);
  EXPECT_EQ(ao.type, RayType::any);
  EXPECT_EQ(ao.rays.size(), 8 * hit_count);
  for (const RayRecord& ray : ao.rays) EXPECT_NEAR(glm::length(ray.direction), 1.0f, 1e-5f);
}

/// The same terrain twice, once as instances of a group: one stretched, one mirrored.
TEST(TraceRays, InstancesGiveTheRaysOfTheirTriangles) {
  Mesh mesh = generate_terrain(3000);
  const Affine placed[] = {scale({0.5f, 1.0f, 1.0f}),
                           translate({250, 5, 0}) * scale({-0.5f, 1, 1})};
  std::vector<Mesh> flat;
  for (const Affine& to_world : placed) {
    flat.push_back(mesh);
    for (Vec3& p : flat.back().positions) p = to_world.point(p);
  }
  mesh.group = 1;
  const SceneData instanced = terrain_scene({mesh}, {{1, placed[0]}, {1, placed[1]}});
  const SceneData triangles = terrain_scene(flat);
  for (const RayKind kind : {RayKind::primary, RayKind::ao, RayKind::diffuse}) {
    const RaySet a = generate_rays(kind, instanced, 32), b = generate_rays(kind, triangles, 32);
    ASSERT_EQ(a.rays.size(), b.rays.size());
    std::size_t near = 0;
    for (std::size_t i = 0; i < a.rays.size(); ++i) {
      near += glm::length(a.rays[i].origin - b.rays[i].origin) < 0.05f &&
              glm::length(a.rays[i].direction - b.rays[i].direction) < 1e-3f;
    }
    EXPECT_GE(near + 20, a.rays.size());  // rounding may send a ray past an edge
  }
}

TEST(TraceRays, SpheresStopPaths) {
  SceneData scene = terrain_scene({generate_terrain(3000)});
  scene.add_sphere({0, 10, 0}, 400, 0);
  prepare_scene(scene);
  const RaySet rays = generate_rays(RayKind::ao, scene, 32);
  std::size_t outside = 0;
  for (const RayRecord& ray : rays.rays) {
    const Vec3 from = ray.origin - Vec3(0, 10, 0);
    if (std::abs(glm::length(from) - 400) > 0.1f) continue;
    EXPECT_GE(glm::dot(from, ray.direction), 0.0f);
    ++outside;
  }
  EXPECT_GT(outside, rays.rays.size() / 4);
}

TEST(TraceRays, BouncesFollowTheMaterials) {
  SceneData scene = terrain_scene({generate_terrain(3000)});
  EXPECT_EQ(generate_rays(RayKind::bounce, scene, 32, 0).rays.size(), 1024u);
  const RaySet rays = generate_rays(RayKind::bounce, scene, 32, 2);
  EXPECT_EQ(rays.type, RayType::closest);
  EXPECT_GT(rays.rays.size(), 100u);
  scene.camera.look_at = {-490, 900, 491};
  expect_error([&] { generate_rays(RayKind::bounce, scene, 32, 2); }, "no path of scene 'terrain'");
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
    const HitComparison comparison =
        compare_hits(hits, reference.hits, position_resolution(rays.rays));
    EXPECT_TRUE(comparison.agrees()) << comparison.first;
    EXPECT_GT(comparison.same, 4090u);
  }
}

INSTANTIATE_TEST_SUITE_P(BunnyRoom, TraceVectors, testing::Values("primary", "diffuse"));

}  // namespace
}  // namespace pt
