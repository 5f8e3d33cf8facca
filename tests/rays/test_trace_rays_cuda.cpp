// Every way of tracing on the GPU finds what the CPU finds, however the rays lie.
#include "accel/instanced_meshes.h"
#include "accel/terrain_rays.h"
#include "common/accel/build/build_triangle_tree.h"
#include "common/error/error.h"
#include "common/rays/trace_rays.h"
#include "common/scene/builtin/generated_scenes.h"
#include "cuda_test.h"

namespace pt {
namespace {

TriangleTreeData terrain_tree(AccelKind accel) {
  const Mesh mesh = generate_terrain(20000);
  TreeOptions options;
  options.accel = accel;
  return build_triangle_tree({&mesh, 1}, {}, options);
}

RaySet uneven_rays(RayKind kind) {
  RaySet rays = terrain_rays(generate_terrain(20000), kind, 64);
  rays.rays.resize(rays.rays.size() - 5);  // the last warp is not full
  rays.rays[7].t_max = 1e-3f;
  rays.rays[9].direction = {0, -1, 0};
  return rays;
}

class CudaTraceRays : public CudaTest {
 protected:
  static void expect_same(const TriangleTreeData& tree, const RaySet& rays, TraceVariant variant) {
    const auto expected = trace_rays_cpu(tree, rays, {}).hits;
    const auto hits = trace_rays_cuda(tree, rays, {variant, 0, 2}, 0).hits;
    const HitComparison comparison = compare_hits(hits, expected);
    // The devices round differently: a ray on an edge may go to either side.
    EXPECT_LE(comparison.other + comparison.missed + comparison.invented, 2u) << comparison.first;
    EXPECT_GE(comparison.same + 20, rays.rays.size());
  }
};

TEST_F(CudaTraceRays, AllVariantsAgreeWithTheCpu) {
  const TriangleTreeData wide = terrain_tree(AccelKind::cwbvh);
  for (const RayKind kind : {RayKind::primary, RayKind::ao, RayKind::diffuse}) {
    const RaySet rays = uneven_rays(kind);
    for (const TraceVariant variant : {TraceVariant::automatic, TraceVariant::threads,
                                       TraceVariant::persistent, TraceVariant::beam})
      expect_same(wide, rays, variant);
    expect_same(terrain_tree(AccelKind::bvh2), rays, TraceVariant::threads);
  }
}

TEST_F(CudaTraceRays, ChoosesByCoherence) {
  const TriangleTreeData tree = terrain_tree(AccelKind::cwbvh);
  const auto chosen = [&](RayKind kind) {
    return trace_rays_cuda(tree, uneven_rays(kind), {}, 0).variant;
  };
  EXPECT_EQ(chosen(RayKind::primary), TraceVariant::beam);
  EXPECT_EQ(chosen(RayKind::ao), TraceVariant::persistent);
  EXPECT_EQ(chosen(RayKind::diffuse), TraceVariant::persistent);
}

TEST_F(CudaTraceRays, InstancesAreForPersistentWarps) {
  const InstancedMeshes world = make_instanced_meshes(3);
  TreeOptions options;
  const auto build = [&] { return build_triangle_tree(world.meshes, world.instances, options); };
  const RaySet rays = rays_through(1000, RayType::closest);
  EXPECT_EQ(trace_rays_cuda(build(), rays, {}, 0).variant, TraceVariant::persistent);
  EXPECT_THROW(trace_rays_cuda(build(), rays, {TraceVariant::beam}, 0), Error);
  options.accel = AccelKind::bvh2;
  EXPECT_EQ(trace_rays_cuda(build(), rays, {}, 0).variant, TraceVariant::threads);
  EXPECT_THROW(trace_rays_cuda(build(), rays, {TraceVariant::persistent}, 0), Error);
}

TEST_F(CudaTraceRays, NoRaysAndNoTriangles) {
  const TriangleTreeData tree = terrain_tree(AccelKind::cwbvh);
  EXPECT_TRUE(trace_rays_cuda(tree, {}, {}, 0).hits.empty());
  const auto hits = trace_rays_cuda({}, uneven_rays(RayKind::primary), {}, 0).hits;
  for (const HitRecord& hit : hits) EXPECT_EQ(hit.t, -1.0f);
}

}  // namespace
}  // namespace pt
