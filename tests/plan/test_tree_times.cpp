// The choice of --builder auto: what building costs against what a better tree saves.
#include <gtest/gtest.h>

#include <algorithm>

#include "common/accel/build/build_triangle_tree.h"
#include "common/options/option_names.h"
#include "common/plan/execution_plan.h"
#include "common/plan/plan_steps.h"

namespace pt {
namespace {

DeviceProperties gpu_beside(int threads = 16) {
  DeviceProperties device;
  device.is_cuda = true, device.host_threads = threads;
  return device;
}

DeviceProperties cpu_with(int threads) {
  DeviceProperties device;
  device.has_avx2 = device.has_ray_blocks = true;
  device.threads = device.host_threads = threads;
  return device;
}

SceneProperties mesh_of(std::size_t triangles) {
  SceneProperties scene;
  scene.triangles = triangles, scene.bsdf_kinds = 1;
  return scene;
}

Options image(int side, int spp) {
  Options options;
  options.width = options.height = side, options.spp = spp, options.max_depth = 8;
  return options;
}

TreeBuilder builder_of(const Options& options, const SceneProperties& scene,
                       const DeviceProperties& device) {
  return plan_execution(options, scene, device).builder;
}

// A tree of a GPU is fitted to one place.
TEST(TreeTimes, WhatMovesHasATreeOfTheHost) {
  SceneProperties scene = mesh_of(10'000'000);
  const Options options = image(512, 4);
  scene.has_motion = true;  // of the camera alone
  EXPECT_TRUE(is_device_builder(builder_of(options, scene, gpu_beside())));
  scene.has_moving_surfaces = true;
  EXPECT_FALSE(is_device_builder(builder_of(options, scene, gpu_beside())));
}

TEST(TreeTimes, RaysGrowWithPixelsSamplesAndShortPaths) {
  ImageSettings settings;
  settings.spp = 10, settings.max_depth = 1, settings.nee = false;
  EXPECT_EQ(expected_rays(100, settings), 1000);
  settings.max_depth = 3;
  EXPECT_EQ(expected_rays(100, settings), 3000);
  settings.max_depth = 50;
  EXPECT_EQ(expected_rays(100, settings), 4000);  // most have left by then
  settings.nee = true;
  EXPECT_GT(expected_rays(100, settings), 4000);
  EXPECT_LT(expected_rays(100, settings), 8000);
}

// A large mesh and few rays: the builder that is done first. The more rays, the better the tree.
TEST(TreeTimes, ATreeIsWorthWhatItsRaysAreWorth) {
  using enum TreeBuilder;
  EXPECT_EQ(builder_of(image(256, 1), mesh_of(2'000'000), cpu_with(2)), sah);
  EXPECT_NE(builder_of(image(256, 16), mesh_of(2'000'000), cpu_with(2)), best);
  EXPECT_EQ(builder_of(image(1024, 4096), mesh_of(100'000), cpu_with(2)), best);
  for (const std::size_t triangles : {1'000'000, 4'000'000, 10'000'000}) {
    for (const int spp : {1, 64}) {
      const TreeBuilder builder = builder_of(image(1024, spp), mesh_of(triangles), gpu_beside());
      EXPECT_TRUE(is_device_builder(builder)) << triangles << ", " << spp;
    }
  }
  EXPECT_EQ(builder_of(image(1024, 512), mesh_of(1'000'000), gpu_beside()), hploc_reinsert);
  EXPECT_FALSE(is_device_builder(builder_of(image(64, 1), mesh_of(500), gpu_beside())));
}

// Slower rays make a better tree worth more, a slower builder less.
TEST(TreeTimes, PlantedConstantsTurnTheBuilder) {
  using C = PlanConstants;
  using enum TreeBuilder;
  struct Case {
    PlanConstant constant;
    double factor;
    TreeBuilder before, after;
    DeviceProperties device;
    int spp;
  };
  const Case cases[] = {{&C::ray_s_thread, 100, sah, best, cpu_with(2), 1},
                        {&C::sah_s, 0.001, hploc, sah, gpu_beside(), 1},
                        {&C::splits_s, 1000, best, sah_reinsert, cpu_with(2), 64},
                        {&C::reinsert_s, 10'000, best, sah, cpu_with(2), 64},
                        {&C::ray_s_multiprocessor, 1000, hploc, hploc_reinsert, gpu_beside(), 1},
                        {&C::hploc_triangle_s, 100, hploc, hploc_reinsert, gpu_beside(), 1},
                        {&C::hploc_reinsert_group_s, 0.01, hploc, hploc_reinsert, gpu_beside(), 1},
                        {&C::best_trace, 1.1, best, sah_reinsert, cpu_with(2), 64}};
  for (const Case& c : cases) {
    const SceneProperties scene = mesh_of(200'000);
    EXPECT_EQ(builder_of(image(512, c.spp), scene, c.device), c.before) << c.factor;
    DeviceProperties device = c.device;
    set_measured(device.constants, c.constant, c.factor * device.constants.*c.constant);
    EXPECT_EQ(builder_of(image(512, c.spp), scene, device), c.after) << c.factor;
  }
}

// What a plan with the fitted constants expects is what was measured.
TEST(TreeTimes, BuildersAreFittedToWhatTheyTook) {
  for (const int threads : {1, 16}) {
    DeviceProperties device = cpu_with(threads);
    const BuilderSeconds seconds{0.3, 0.5, 1.2};
    fit_builders(device.constants, 100'000, threads, seconds);
    const std::vector<TreeTimes> times = expected_tree_times({100'000, 1, 0}, device, 0);
    ASSERT_EQ(times.size(), 3u);
    EXPECT_NEAR(times[0].build_s, 0.3, 1e-9);
    EXPECT_NEAR(times[1].build_s, 0.5, 1e-9);
    EXPECT_NEAR(times[2].build_s, 0.5 + device.constants.splits_tried * 1.2, 1e-9);
    EXPECT_EQ(origin_of(device.constants, {&PlanConstants::sah_s, &PlanConstants::reinsert_s,
                                           &PlanConstants::splits_s}),
              "measured here");
    PlanConstants none;  // reinsertion was not slower: it keeps its constant
    fit_builders(none, 100'000, threads, {0.3, 0.3, 1.2});
    EXPECT_FALSE(is_measured(none, &PlanConstants::reinsert_s));
    EXPECT_EQ(none.reinsert_s, PlanConstants().reinsert_s);
  }
}

TEST(TreeTimes, ATimeLimitBoundsWhatATreeCanSave) {
  Options options = image(1024, 100'000);
  EXPECT_EQ(builder_of(options, mesh_of(2'000'000), cpu_with(2)), TreeBuilder::best);
  options.time_limit = 1;
  EXPECT_EQ(builder_of(options, mesh_of(2'000'000), cpu_with(2)), TreeBuilder::sah);
}

TEST(TreeTimes, APartAndACropHaveFewerRays) {
  Options options = image(1024, 200);
  const SceneProperties scene = mesh_of(200'000);
  ASSERT_EQ(builder_of(options, scene, cpu_with(4)), TreeBuilder::best);
  options.crop = CropWindow{0, 0, 32, 32};
  EXPECT_EQ(builder_of(options, scene, cpu_with(4)), TreeBuilder::sah);
  options.crop = {}, options.part.count = 1024, options.checkpoint.file = "part";
  EXPECT_EQ(builder_of(options, scene, cpu_with(4)), TreeBuilder::sah);
}

TEST(TreeTimes, TreesThatACpuTracesAreBuiltByTheHost) {
  EXPECT_FALSE(is_device_builder(builder_of(image(1024, 1), mesh_of(10'000'000), cpu_with(16))));
}

TEST(TreeTimes, EachGroupTakesADeviceItsLaunches) {
  SceneProperties scene = mesh_of(50'000);
  scene.instances = 2000, scene.tree_groups = 1000;
  EXPECT_FALSE(is_device_builder(builder_of(image(1024, 64), scene, gpu_beside())));
  for (const TreeTimes& time : expected_tree_times({50'000, 1000, 0}, gpu_beside(), 0)) {
    if (is_device_builder(time.builder)) {
      EXPECT_GT(time.build_s, 2);
    }
  }
}

TEST(TreeTimes, GivenAndBuiltOnesHold) {
  Options options = image(1024, 1);
  options.builder = TreeBuilder::sbvh;
  EXPECT_EQ(builder_of(options, mesh_of(10'000'000), gpu_beside()), TreeBuilder::sbvh);
  SceneProperties built = mesh_of(10'000'000);
  built.structure = Accel::cwbvh, built.builder = TreeBuilder::best;
  EXPECT_EQ(builder_of(image(1024, 1), built, gpu_beside()), TreeBuilder::best);
}

// --explain tells the times by which the choice was made: the first is the least.
TEST(TreeTimes, AreSaid) {
  const ExecutionPlan plan = plan_execution(image(1024, 64), mesh_of(1'000'000), gpu_beside());
  const auto decision =
      std::ranges::find(plan.decisions, std::string("builder"), &Decision::option);
  ASSERT_NE(decision, plan.decisions.end());
  EXPECT_EQ(decision->value, to_string(plan.builder));
  const std::vector<TreeTimes> times =
      expected_tree_times({1e6, 1, expected_rays(1024 * 1024, image(1024, 64))}, gpu_beside(), 0);
  EXPECT_EQ(times.size(), 5u);
  for (const TreeTimes& time : times) {
    if (time.builder == plan.builder) continue;
    EXPECT_NE(decision->reason.find("; " + to_string(time.builder) + " 0."), std::string::npos)
        << decision->reason;
  }
  EXPECT_EQ(decision->reason.substr(0, 11), "expected 0.");
}

}  // namespace
}  // namespace pt
