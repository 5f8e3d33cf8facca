// Every BSDF, with and without masks, and lights of all kinds: on a GPU both modes give one image,
// bit for bit, and one that is close to the CPU's.
#include "common/image/compare/compare.h"
#include "common/scene/prepare/prepare_scene.h"
#include "cuda_test.h"
#include "medium/filled_glasses.h"
#include "mode_cases.h"
#include "scene/lit_room.h"
#include "scene/masked_room.h"
#include "scene/material_room.h"
#include "scene/mixed_scene.h"

namespace pt {
namespace {

struct Room {
  const char* name;
  SceneData (*make)();
};

bool has_queues(Compaction strategy) { return compaction_info(strategy).has_queues; }
bool writes_tags(Compaction strategy) { return !compaction_info(strategy).appends; }

void PrintTo(const Room& room, std::ostream* out) { *out << room.name; }

Rendered render_small(SceneData scene, const Settings& settings) {
  Options options =
      with(Options(), {{"width", "45"}, {"height", "41"}, {"spp", "4"}, {"max-depth", "6"}});
  apply(options, settings);
  prepare_scene(scene, options);
  return take_image(*make_renderer(options, scene, choose_device(options.device)));
}

class GpuRoomsOf : public CudaTest, public testing::WithParamInterface<Room> {
 protected:
  static Rendered render(const Settings& settings) {
    return render_small(GetParam().make(), settings);
  }
};
INSTANTIATE_TEST_SUITE_P(
    Cuda, GpuRoomsOf,
    testing::Values(Room{"materials", [] { return material_room(false); }},
                    Room{"masked_materials", [] { return material_room(true); }},
                    Room{"masked_room", masked_room}, Room{"lights", lit_room}),
    [](const auto& room) { return room.param.name; });

TEST_P(GpuRoomsOf, WavefrontEqualsMegakernel) {
  const Rendered expected = render({{"device", "cuda"}, {"mode", "megakernel"}});
  EXPECT_EQ(expected.counts.nonfinite_samples, 0u);
  for (const std::string& accel : structures(AccelKind::bvh2, {AccelKind::brute})) {
    for (const std::string& compaction : names_of(Compaction::atomic)) {
      for (const std::string& layout : names_of(PoolLayout::aos)) {
        const char* const finish = layout == "sectors" ? "131072" : "0";
        SCOPED_TRACE(testing::Message()
                     << accel << ", " << compaction << ", " << finish << ", " << layout);
        const Settings settings{{"device", "cuda"},       {"mode", "wavefront"},
                                {"accel", accel},         {"compaction", compaction},
                                {"finish-paths", finish}, {"layout", layout}};
        if (!has_plan(with(Options(), settings), GetParam().make())) continue;
        expect_same(render(settings), expected);
      }
    }
  }
}

class CudaVotingMaterials : public CudaTest {};

// Every BSDF, shaded by lanes that have left the traversal at different times.
TEST_F(CudaVotingMaterials, EqualTheLoop) {
  const auto render = [](const char* kernel, const char* max_depth) {
    return render_small(material_room(false), {{"device", "cuda"},
                                               {"mode", "megakernel"},
                                               {"accel", "cwbvh"},
                                               {"kernel", kernel},
                                               {"max-depth", max_depth}});
  };
  for (const char* max_depth : {"6", "20"}) {
    const Rendered voted = render("vote", max_depth);
    expect_same(voted, render("loop", max_depth));
  }
}

// By default the surfaces of a scene with several BSDF types are ordered.
TEST_P(GpuRoomsOf, OrderedSurfacesEqualMegakernel) {
  const Rendered expected = render({{"device", "cuda"}, {"mode", "megakernel"}});
  for (const char* order : {"auto", "on", "off"}) {
    for (const std::string& compaction : names_where(Compaction::atomic, has_queues)) {
      for (const char* pool : {"1000", "auto"}) {
        SCOPED_TRACE(testing::Message() << order << ", " << compaction << ", " << pool);
        expect_same(render({{"device", "cuda"},
                            {"mode", "wavefront"},
                            {"order-surfaces", order},
                            {"compaction", compaction},
                            {"pool-size", pool},
                            {"finish-paths", "0"}}),
                    expected);
      }
    }
  }
}

TEST_P(GpuRoomsOf, AreCloseToTheCpu) {
  const Settings many{{"spp", "64"}};
  Settings cuda = many, cpu = many;
  cuda.emplace_back("device", "cuda");
  cpu.insert(cpu.end(), {{"device", "cpu"}, {"mode", "megakernel"}});
  const Image a = render(cuda).image, b = render(cpu).image;
  double sum_a = 0, sum_b = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) sum_a += a.rgb[i], sum_b += b.rgb[i];
  EXPECT_NEAR(sum_a / sum_b, 1.0, 5e-3);
}

class CudaPersistent : public CudaTest {
 protected:
  /// By the wavefront on the GPU, as the settings say, and by the megakernel.
  static void expect_equal(const SceneData& scene, Settings settings, bool persistent) {
    settings.insert(settings.end(), {{"device", "cuda"}, {"mode", "wavefront"}, {"spp", "16"}});
    const Settings megakernel = {{"device", "cuda"}, {"spp", "16"}, {"mode", "megakernel"}};
    const Rendered found = render_small(scene, settings);
    expect_same(found, render_small(scene, megakernel));
    std::uint64_t sorted = 0;  // only where warps persist has this stage anything to do
    for (const StageTime& stage : found.run.stages) {
      if (stage.stage == "route_hits") sorted += stage.launches;
    }
    EXPECT_EQ(sorted > 0, persistent);
  }
};

using CudaInstancedScenes = CudaPersistent;

TEST_F(CudaInstancedScenes, PersistentWarpsTraceThemWithoutSpheres) {
  SceneData scene = mixed_scene();
  expect_equal(scene, {{"finish-paths", "0"}}, false);
  scene.spheres.clear(), scene.sphere_material.clear();
  for (const char* pool : {"100", "3001", "auto"}) {
    for (const std::string& layout : names_of(PoolLayout::soa)) {
      for (const std::string& builder : names_of(TreeBuilder::sah, {TreeBuilder::automatic})) {
        SCOPED_TRACE(testing::Message() << pool << ", " << layout << ", " << builder);
        expect_equal(scene,
                     {{"accel", "cwbvh"},
                      {"pool-size", pool},
                      {"layout", layout},
                      {"builder", builder},
                      {"finish-paths", "0"}},
                     true);
      }
    }
  }
}

using CudaMasks = CudaPersistent;

TEST_F(CudaMasks, PersistentWarpsAskThem) {
  for (const char* pool : {"100", "3001", "auto"}) {
    for (const std::string& schedule : names_of(Schedule::host, {Schedule::automatic})) {
      for (const std::string& builder : names_of(TreeBuilder::sah, {TreeBuilder::automatic})) {
        SCOPED_TRACE(testing::Message() << pool << ", " << schedule << ", " << builder);
        expect_equal(masked_room(),
                     {{"pool-size", pool},
                      {"schedule", schedule},
                      {"builder", builder},
                      {"finish-paths", "0"}},
                     true);
      }
    }
  }
}

TEST_F(CudaMasks, LimitCameraRays) {
  expect_equal(limited_room(), {{"finish-paths", "0"}}, true);
  expect_equal(limited_room(), {}, false);  // blocks follow all paths of so small an image
  expect_equal(limited_room(), {{"accel", "bvh2"}}, false);
}

TEST_F(CudaMasks, AThreadPerRayAsksThemAmongSpheresAndInstances) {
  const Settings tiny{{"pool-size", "3001"}, {"finish-paths", "0"}};
  SceneData with_sphere = masked_room();
  with_sphere.add_sphere({0, 0, 1}, 0.5f, with_sphere.add_material(make_diffuse(Color(0.5f))));
  expect_equal(with_sphere, tiny, false);
  SceneData instanced = masked_room();
  for (std::size_t i = 0; i < 20; ++i) instanced.meshes[i].group = 1;
  instanced.instances = {{1, rotate({0, 1, 0}, 30)}, {1, translate({1, 0, 0})}};
  expect_equal(instanced, tiny, false);
  for (const std::string& compaction : names_where(Compaction::cub, writes_tags)) {
    expect_equal(masked_room(), {{"compaction", compaction}}, false);
  }
}

class CudaKernels : public CudaTest {};

// Traversal and spills take up to 860 bytes of a thread's local memory. A kernel that hands its
// scene to functions has a copy of it there, too: 700 bytes, and up to twice the time.
TEST_F(CudaKernels, KeepNoCopyOfTheScene) {
  const auto glasses = [] { return filled_glasses(); };
  for (const Room& room : {Room{"mixed", mixed_scene},
                           {"masked", masked_room},
                           {"limited", limited_room},
                           {"media", glasses}}) {
    for (const Settings& how :
         std::vector<Settings>{{{"mode", "megakernel"}},
                               {{"mode", "megakernel"}, {"accel", "bvh2"}},
                               {{"mode", "wavefront"}},
                               {{"mode", "wavefront"}, {"accel", "bvh2"}},
                               {{"mode", "wavefront"}, {"stages", "fused"}, {"accel", "bvh2"}}}) {
      const Options options =
          with(with(Options(), how), {{"device", "cuda"}, {"width", "45"}, {"height", "41"}});
      SceneData scene = room.make();
      prepare_scene(scene, options);
      const auto renderer = make_renderer(options, scene, choose_device(options.device));
      take_image(*renderer);
      const RenderReport report = report_of(*renderer);
      ASSERT_FALSE(report.kernels.empty());
      for (const KernelInfo& kernel : report.kernels) {
        EXPECT_LT(kernel.spill_bytes, 1000u) << kernel.name << ", " << room.name;
      }
    }
  }
}

}  // namespace
}  // namespace pt
