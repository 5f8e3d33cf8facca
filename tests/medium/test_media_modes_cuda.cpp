// Scenes with media give the same bits in all modes on a GPU, too, and nearly the CPU's image.
#include <gtest/gtest.h>

#include "cloud_modes.h"
#include "common/error/error.h"
#include "common/image/compare/compare.h"
#include "common/plan/execution_plan.h"
#include "cuda_test.h"
#include "medium/filled_glasses.h"

namespace pt {
namespace {

class CudaMedia : public CudaTest {};

Options gpu_options(const std::string& mode, const Settings& more = {}) {
  return with(with(cloud_options(mode), {{"device", "cuda:0"}, {"width", "61"}}), more);
}

TEST_F(CudaMedia, MegakernelDoesNotDependOnHow) {
  const SceneData scene = clouds();
  const Rendered expected = render_clouds(scene, gpu_options("megakernel"));
  expect_plausible(expected, gpu_options("megakernel"));
  for (const Settings& more : {Settings{{"work", "pixel"}}, Settings{{"work", "sample"}},
                               Settings{{"block", "33x1"}}, Settings{{"block", "32x16"}}}) {
    const Options options = gpu_options("megakernel", more);
    SCOPED_TRACE(command_of(options));
    expect_same(render_clouds(scene, options), expected);
  }
}

TEST_F(CudaMedia, WavefrontEqualsMegakernel) {
  const SceneData scene = clouds();
  const Rendered expected = render_clouds(scene, gpu_options("megakernel"));
  const std::vector<Choice> choices{{"compaction", names_of(Compaction::atomic)},
                                    {"pool-size", {"auto", "300", "11", "3660", "3661"}},
                                    {"regenerate", {"on", "off"}},
                                    {"finish-paths", {"0", "1", "700", "131072"}},
                                    {"layout", names_of(PoolLayout::soa)},
                                    {"stages", names_of(Stages::split, {Stages::automatic})},
                                    {"wave-collisions", {"0", "1", "2", "7", "1000"}},
                                    {"schedule", names_of(Schedule::host)},
                                    {"order-surfaces", {"auto", "on", "off"}}};
  int compared = 0;
  for (const Settings& settings : variations(choices, 24, 8)) {
    const Options options = gpu_options("wavefront", settings);
    if (!has_plan(options, scene)) continue;
    SCOPED_TRACE(command_of(options));
    expect_same(render_clouds(scene, options), expected);
    if (HasFailure()) return;
    ++compared;
  }
  EXPECT_GT(compared, 15);
}

TEST_F(CudaMedia, OverlappingOnesAreTheSameInBothModes) {
  const SceneData scene = overlapping_clouds();
  const Rendered expected = render_clouds(scene, gpu_options("megakernel"));
  expect_plausible(expected, gpu_options("megakernel"));
  for (const Settings& more : {Settings{}, Settings{{"pool-size", "300"}},
                               Settings{{"wave-collisions", "2"}}, Settings{{"stages", "fused"}}}) {
    const Options options = gpu_options("wavefront", more);
    SCOPED_TRACE(command_of(options));
    expect_same(render_clouds(scene, options), expected);
  }
}

// CPU and GPU round differently, and a path that takes another way differs in all that follows.
TEST_F(CudaMedia, AreAsOnTheCpu) {
  const SceneData scene = clouds();
  const Settings more{{"width", "120"}, {"height", "80"}, {"spp", "16"}};
  const Rendered gpu = render_clouds(scene, gpu_options("megakernel", more));
  const Rendered cpu =
      render_clouds(scene, with(gpu_options("megakernel", more), {{"device", "cpu"}}));
  const ImageDifference difference = compare_images(gpu.image, cpu.image, 1e-3);
  EXPECT_LE(static_cast<double>(difference.pixels_past_tolerance), 0.02 * 120 * 80);
  EXPECT_EQ(gpu.counts.paths, cpu.counts.paths);
  EXPECT_NEAR(static_cast<double>(gpu.counts.rays), static_cast<double>(cpu.counts.rays),
              2e-3 * static_cast<double>(cpu.counts.rays));
}

// A shadow ray would go on behind such a boundary.
TEST_F(CudaMedia, HaveNoWideTreesWhereBoundariesHaveNoBsdf) {
  EXPECT_THROW(render_clouds(clouds(), gpu_options("wavefront", {{"accel", "cwbvh"}})), Error);
}

ExecutionPlan plan_for(SceneData scene, const Options& options) {
  const DeviceInfo device = choose_device(options.device);
  prepare_scene_for(scene, options, device);
  return plan_execution(options, scene.properties, device.properties);
}

TEST_F(CudaMedia, InGlassesOfTrianglesAreTracedAsScenesWithoutMedia) {
  for (const bool has_masks : {false, true}) {
    const SceneData scene = filled_glasses(has_masks);
    const ExecutionPlan waves = plan_for(scene, gpu_options("wavefront"));
    EXPECT_TRUE(waves.persistent_warps && waves.finishes_in_blocks);
    EXPECT_EQ(plan_for(scene, gpu_options("megakernel")).megakernel, MegakernelKind::sort);

    const Options loop = gpu_options("megakernel", {{"kernel", "loop"}});
    const Rendered expected = render_clouds(scene, loop);
    expect_plausible(expected, loop);
    expect_same(render_clouds(scene, gpu_options("megakernel")), expected);
    for (const Settings& more :
         {Settings{}, Settings{{"finish-paths", "0"}}, Settings{{"finish-paths", "1"}},
          Settings{{"finish-paths", "700"}}, Settings{{"finish-paths", "1000000"}},
          Settings{{"finish-paths", "0"}, {"wave-collisions", "1"}},
          Settings{{"finish-paths", "300"}, {"wave-collisions", "3"}},
          Settings{{"finish-paths", "300"}, {"pool-size", "500"}},
          Settings{{"finish-paths", "0"}, {"layout", "aos"}},
          Settings{{"finish-paths", "0"}, {"schedule", "host"}}, Settings{{"accel", "bvh2"}},
          Settings{{"persistent", "off"}}, Settings{{"stages", "fused"}},
          Settings{{"compaction", "cub"}}}) {
      const Options options = gpu_options("wavefront", more);
      SCOPED_TRACE(command_of(options));
      expect_same(render_clouds(scene, options), expected);
    }
    const Settings tree{{"light-selection", "tree"}};
    expect_same(render_clouds(scene, gpu_options("wavefront", tree)),
                render_clouds(scene, gpu_options("megakernel", tree)));
  }
}

// The launch is refused while a graph is recorded, which must end all the same.
TEST_F(CudaMedia, BlocksThatDoNotFitAreRefusedInGraphs) {
  EXPECT_THROW(render_clouds(clouds(), gpu_options("wavefront", {{"schedule", "graph"},
                                                                 {"finish-paths", "0"},
                                                                 {"stage-block", "1024"}})),
               Error);
}

}  // namespace
}  // namespace pt
