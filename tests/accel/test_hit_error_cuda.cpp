// On the GPU, too, no structure, builder or way of tracing hides a hit.
#include <cstring>
#include <filesystem>

#include "accel/hard_hits.h"
#include "accel/instance_crowds.h"
#include "accel/instanced_meshes.h"
#include "accel/tree_kinds.h"
#include "common/rays/trace_rays.h"
#include "cuda_test.h"
#include "mode_cases.h"
#include "shared_file.h"

namespace pt {
namespace {

using Hits = std::vector<HitRecord>;

std::size_t count_different(const Hits& a, const Hits& b) {
  std::size_t different = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    different += std::memcmp(&a[i], &b[i], sizeof(HitRecord)) != 0;
  }
  return different;
}

class CudaHits : public CudaTest {
 protected:
  /// All that trees and variants find of these rays is what threads find in `expected`.
  static void expect_same(const std::vector<Mesh>& meshes, const std::vector<Instance>& instances,
                          const RaySet& rays, const TriangleTreeData& tree) {
    const Hits expected = trace_rays_cuda(tree, rays, {TraceVariant::threads, 0, 1}, 0).hits;
    for (const TreeKind& kind : tree_kinds) {
      const TriangleTreeData built = kind.build(meshes, instances);
      for (const TraceVariant variant : variants(kind.accel, instances.empty())) {
        const Hits hits = trace_rays_cuda(built, rays, {variant, 0, 1}, 0).hits;
        EXPECT_EQ(count_different(hits, expected), 0u)
            << kind.name << ", variant " << static_cast<int>(variant);
      }
    }
    for (const AccelKind accel : {AccelKind::bvh2, AccelKind::cwbvh}) {
      for (const TreeBuilder builder :
           {TreeBuilder::lbvh, TreeBuilder::hploc, TreeBuilder::hploc_reinsert}) {
        TreeOptions options;
        options.accel = accel, options.builder = builder;
        for (const TraceVariant variant : variants(accel, instances.empty())) {
          const Hits hits =
              build_and_trace_cuda(meshes, instances, options, rays, {variant, 0, 1}, 0)
                  .result.hits;
          EXPECT_EQ(count_different(hits, expected), 0u)
              << "builder " << static_cast<int>(builder) << ", variant "
              << static_cast<int>(variant);
        }
      }
    }
  }

 private:
  static std::vector<TraceVariant> variants(AccelKind accel, bool plain) {
    if (accel == AccelKind::bvh2) return {TraceVariant::threads};
    if (!plain) return {TraceVariant::threads, TraceVariant::persistent};
    return {TraceVariant::threads, TraceVariant::persistent, TraceVariant::beam};
  }
};

class CudaHardHits : public CudaHits, public testing::WithParamInterface<MeshKind> {};
INSTANTIATE_TEST_SUITE_P(Cuda, CudaHardHits, testing::ValuesIn(hard_mesh_kinds),
                         [](const auto& kind) { return std::string(kind.param.name); });

TEST_P(CudaHardHits, AreTheSameInEveryStructure) {
  for (const auto& [count, each] : {std::pair{40, 4000}, {3000, 70000}}) {
    const Mesh mesh = GetParam().make(count);
    for (const RayType type : {RayType::closest, RayType::any}) {
      const RaySet rays = hard_rays(mesh, each, type);
      expect_same({mesh}, {}, rays, (count < 100 ? brute_kind : tree_kinds[0]).build({mesh}));
    }
  }
}

TEST_P(CudaHardHits, AreTheSameInInstances) {
  Mesh mesh = GetParam().make(60);
  const Mesh world = mesh;
  mesh.group = 1;
  const std::vector<Instance> instances = hard_instances(12);
  for (const RayType type : {RayType::closest, RayType::any}) {
    const RaySet rays = hard_rays(world, 5000, type);
    expect_same({world, mesh}, instances, rays, brute_kind.build({world, mesh}, instances));
  }
}

class CudaInstances : public CudaHits {};

TEST_F(CudaInstances, ManyGroupsAreMetAlike) {
  const InstancedMeshes world = make_instanced_meshes(30);
  for (const RayType type : {RayType::closest, RayType::any}) {
    RaySet rays = rays_through(20001, type);  // the last warp is not full
    rays.rays[77].t_max = 1e-3f;
    expect_same(world.meshes, world.instances, rays,
                brute_kind.build(world.meshes, world.instances));
  }
}

// Where a tenth of the hits is moved into the part of the ray that lies in the instance's box.
TEST_F(CudaInstances, SeenFromAfarAreMetAlike) {
  TestRandom random(34);
  const std::vector<Mesh> meshes = squares();
  for (const double distance : {1e4, 1e6}) {
    const Crowd crowd = crowd_from_afar(random, distance);
    const TriangleTreeData brute = brute_kind.build(meshes, crowd.instances);
    RaySet rays;
    for (const Ray& ray : crowd.rays) {
      rays.rays.push_back({ray.origin, 0.0f, ray.direction, infinite_distance});
    }
    expect_same(meshes, crowd.instances, rays, brute);
    // Shadow rays that end at what is met, or just behind.
    const Hits hits = trace_rays_cuda(brute, rays, {TraceVariant::threads, 0, 1}, 0).hits;
    rays.type = RayType::any;
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const float t = hits[i].t;
      if (t > 0.0f) rays.rays[i].t_max = i % 2 == 0 ? t : std::nextafterf(t, infinite_distance);
    }
    expect_same(meshes, crowd.instances, rays, brute);
  }
}

/// Files in the folder `shared`, which are no part of the repository.
class CudaSharedScenes : public CudaTest, public testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Files, CudaSharedScenes,
                         testing::Values("modern-hall/scene.xml", "grey-white-room/scene.xml",
                                         "balloon-gltf/scene.gltf"),
                         [](const auto& file) {
                           std::string name = std::string(file.param).substr(0, 6);
                           name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
                           return name;
                         });

TEST_P(CudaSharedScenes, GiveOneImageHoweverTheyAreTraced) {
  const std::string path = shared_file(std::string("scenes/") + GetParam());
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  const auto options_of = [&](const std::string& mode, const Settings& how) {
    Settings settings{
        {"scene", path}, {"width", "640"}, {"height", "360"}, {"spp", "8"}, {"max-depth", "8"}};
    settings.insert(settings.end(), how.begin(), how.end());
    return cuda_options(mode, settings);
  };
  const Rendered expected = render_options(options_of("megakernel", {}));
  const std::pair<const char*, Settings> ways[] = {
      {"wavefront", {}},
      {"wavefront", {{"accel", "bvh2"}, {"builder", "sbvh"}}},
      {"wavefront", {{"accel", "cwbvh"}, {"builder", "sbvh"}}},
      {"wavefront", {{"builder", "hploc"}, {"compaction", "cub"}}},
      {"megakernel", {{"accel", "cwbvh"}, {"builder", "lbvh"}}},
      {"megakernel", {{"accel", "bvh2"}, {"builder", "hploc"}}}};
  for (const auto& [mode, how] : ways) {
    const Options options = options_of(mode, how);
    SCOPED_TRACE(command_of(options));
    expect_same(render_options(options), expected);
  }
}

}  // namespace
}  // namespace pt
