// Scenes with instances, and with spheres besides triangles, whose trees the GPU has built: hits
// and images are those of trees built on the CPU, bit for bit.
#include "app/commands/commands.h"
#include "common/accel/build/tree_statistics.h"
#include "common/error/error.h"
#include "common/options/option_names.h"
#include "common/rays/trace_rays.h"
#include "common/scene/prepare/prepare_scene.h"
#include "cuda_test.h"
#include "mode_cases.h"
#include "scene/mixed_scene.h"
#include "temp_folder.h"

namespace pt {
namespace {

constexpr TreeBuilder device_builders[] = {TreeBuilder::lbvh, TreeBuilder::hploc,
                                           TreeBuilder::hploc_reinsert};

class CudaDeviceTree : public CudaTest {
 protected:
  /// Checks both structures by all builders.
  template <class Check>
  static void for_each_tree(Check&& check) {
    for (const AccelKind accel : {AccelKind::bvh2, AccelKind::cwbvh}) {
      for (const TreeBuilder builder : device_builders) {
        TreeOptions options;
        options.accel = accel, options.builder = builder;
        SCOPED_TRACE(to_string(accel) + ", " + to_string(builder));
        check(options);
      }
    }
  }

  static TreeOptions of_the_cpu(TreeOptions options) {
    options.builder = TreeBuilder::sah;
    return options;
  }

  static void expect_same_hits(const InstancedMeshes& world, const TreeOptions& options) {
    const TriangleTreeData tree =
        build_triangle_tree(world.meshes, world.instances, of_the_cpu(options));
    for (const RayType type : {RayType::closest, RayType::any}) {
      const RaySet rays = rays_through(20'000, type);
      const auto expected = trace_rays_cuda(tree, rays, {}, 0).hits;
      const auto hits =
          build_and_trace_cuda(world.meshes, world.instances, options, rays, {}, 0).result.hits;
      ASSERT_EQ(hits.size(), expected.size());
      std::size_t differ = 0, met = 0;
      for (std::size_t i = 0; i < hits.size(); ++i) {
        differ += std::memcmp(&hits[i], &expected[i], sizeof(HitRecord)) != 0;
        met += hits[i].t >= 0;
      }
      EXPECT_EQ(differ, 0u);
      EXPECT_GT(met, hits.size() / 50);
    }
  }
};

TEST_F(CudaDeviceTree, InstancesAreHitAsInTheCpusTree) {
  for (const std::uint32_t groups : {1u, 3u, 400u}) {
    SCOPED_TRACE(testing::Message() << groups << " groups");
    const InstancedMeshes world = make_instanced_meshes(groups);
    for_each_tree([&](const TreeOptions& options) { expect_same_hits(world, options); });
  }
}

TEST_F(CudaDeviceTree, WithoutInstancesTheWorldIsHitAsInTheCpusTree) {
  InstancedMeshes world = make_instanced_meshes(10);
  world.instances.clear();
  for_each_tree([&](const TreeOptions& options) { expect_same_hits(world, options); });
}

// Nodes of many groups fill several blocks before they are joined.
TEST_F(CudaDeviceTree, LargeGroupsAmongSmallOnes) {
  InstancedMeshes world = make_instanced_meshes(20);
  for (const std::uint32_t group : {5u, 6u, 7u}) {
    world.meshes.push_back(make_soup(60'000, 1, {}, group));
    world.meshes.back().group = group;
  }
  for_each_tree([&](const TreeOptions& options) { expect_same_hits(world, options); });
}

TEST_F(CudaDeviceTree, SummariesCountWhatIsThere) {
  const InstancedMeshes world = make_instanced_meshes(100);
  for_each_tree([&](const TreeOptions& options) {
    const TreeSummary cpu =
        summarize(build_triangle_tree(world.meshes, world.instances, of_the_cpu(options)));
    const TreeSummary gpu =
        build_and_trace_cuda(world.meshes, world.instances, options, {}, {}, 0).tree;
    EXPECT_EQ(gpu.builder, to_string(options.builder));
    EXPECT_EQ(gpu.quality.slots, cpu.quality.slots);
    EXPECT_GT(gpu.build_ms, 0);
    const std::uint64_t node_bytes =
        options.accel == AccelKind::bvh2 ? sizeof(Bvh2Node) : sizeof(CwbvhNode);
    EXPECT_EQ(gpu.size_bytes - gpu.quality.nodes * node_bytes,
              cpu.size_bytes - cpu.quality.nodes * node_bytes);
    const double cpu_cost = cpu.quality.sah_cost(1), gpu_cost = gpu.quality.sah_cost(1);
    EXPECT_GT(gpu_cost, 0.9 * cpu_cost);
    EXPECT_LT(gpu_cost, 1.5 * cpu_cost);
    EXPECT_GT(gpu.quality.depth, cpu.quality.depth / 2);
  });
}

TEST_F(CudaDeviceTree, NothingIsMissedByAllRays) {
  InstancedMeshes world;
  world.meshes.push_back(make_soup(10, 4));
  world.meshes.back().group = 3;
  world.instances.push_back({4, {}});
  for_each_tree([&](const TreeOptions& options) {
    const BuiltTrace trace = build_and_trace_cuda(world.meshes, world.instances, options,
                                                  rays_through(100, RayType::closest), {}, 0);
    for (const HitRecord& hit : trace.result.hits) ASSERT_EQ(hit.t, -1.0f);
    EXPECT_EQ(trace.tree.quality.nodes, 0u);
  });
}

TEST_F(CudaDeviceTree, NamesTheMeshThatIsWrong) {
  InstancedMeshes world = make_instanced_meshes(3);
  world.meshes[2].triangles[0].v[1] = 100'000;
  for_each_tree([&](const TreeOptions& options) {
    expect_error([&] { build_and_trace_cuda(world.meshes, world.instances, options, {}, {}, 0); },
                 "mesh 2, triangle 0: vertex 100000");
  });
}

struct RenderedScene {
  Rendered rendered;
  RenderReport report;
};

RenderedScene render_scene(SceneData scene, const Options& options) {
  const DeviceInfo device = choose_device(options.device);
  prepare_scene(scene, options);
  const auto renderer = make_renderer(options, scene, device);
  RenderedScene result;
  result.rendered = take_image(*renderer);
  renderer->describe(result.report);
  return result;
}

TEST_F(CudaDeviceTree, MixedScenesGiveTheSameImage) {
  SceneData without_instances = mixed_scene();
  without_instances.instances.clear();
  for (const SceneData& scene : {mixed_scene(), without_instances}) {
    for (const char* mode : {"megakernel", "wavefront"}) {
      Options options = with({}, {{"width", "67"},
                                  {"height", "41"},
                                  {"spp", "4"},
                                  {"mode", mode},
                                  {"max-depth", "5"},
                                  {"device", "cuda"},
                                  {"builder", "sah"}});
      const Rendered expected = render_scene(scene, options).rendered;
      expect_plausible(expected, options);
      for_each_tree([&](const TreeOptions& tree) {
        options.accel = tree.accel, options.builder = tree.builder;
        if (!has_plan(options, scene)) return;
        const RenderedScene found = render_scene(scene, options);
        expect_same(found.rendered, expected);
        EXPECT_EQ(found.report.scene.tree.builder, to_string(tree.builder));
        EXPECT_GT(found.report.scene.tree.nodes, 1u);
        EXPECT_GT(found.report.scene.tree.sah_cost, 1.0);
        EXPECT_GT(found.report.scene.tree.bytes_per_triangle, 0.0);
        EXPECT_GT(found.report.scene.tree.build_ms, 0.0);
      });
    }
  }
}

// Meshes of groups that nobody places leave nothing to build.
TEST_F(CudaDeviceTree, ScenesWhoseMeshesAreNotUsed) {
  SceneData scene = mixed_scene();
  for (Mesh& mesh : scene.meshes) mesh.group = 500;
  scene.quads.clear(), scene.quad_material.clear();
  Options options = with({}, {{"width", "31"},
                              {"height", "21"},
                              {"spp", "2"},
                              {"device", "cuda"},
                              {"builder", "sah"},
                              {"accel", "bvh2"}});
  const Rendered expected = render_scene(scene, options).rendered;
  options.builder = TreeBuilder::hploc;
  expect_same(render_scene(scene, options).rendered, expected);
}

TEST_F(CudaDeviceTree, TheTraceCommandBuildsOnTheDevice) {
  const TempFolder folder;
  for (const std::string scene : {"instances:20", "terrain:3K"}) {
    RaysCommand rays;
    rays.scene = scene, rays.output = folder.file("r"), rays.size = 64, rays.kind = RayKind::bounce,
    rays.bounces = 1;
    rays_command(rays);
    TraceCommand command;
    command.mesh = scene, command.rays = rays.output, command.quiet = true;
    command.device = {DeviceChoice::Kind::cuda, 0};
    command.runs.variant = TraceVariant::threads;  // for both structures
    command.output = folder.file("h");
    EXPECT_EQ(trace_command(command), 0);
    command.hits = command.output, command.output = folder.file("g");
    command.csv = folder.file(scene.substr(0, 4) + ".csv");
    for_each_tree([&](const TreeOptions& tree) {
      command.accel = tree.accel, command.builder = tree.builder;
      EXPECT_EQ(trace_command(command), 0);
      EXPECT_EQ(read_text(command.output), read_text(command.hits));
    });
    const std::string table = read_text(command.csv);
    EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 7);
    for (const char* text : {"bvh2,lbvh", "bvh2,hploc,", "bvh2,hploc-reinsert", "cwbvh,lbvh",
                             "cwbvh,hploc,", "cwbvh,hploc-reinsert"}) {
      EXPECT_NE(table.find(text), std::string::npos) << table;
    }
  }
}

TEST_F(CudaDeviceTree, BruteForceNeedsNoBuilder) {
  TraceCommand command;
  command.device = {DeviceChoice::Kind::cuda, 0};
  command.accel = AccelKind::brute, command.builder = TreeBuilder::hploc;
  expect_error([&] { trace_command(command); }, "--builder hploc: builds binary and wide trees");
}

}  // namespace
}  // namespace pt
