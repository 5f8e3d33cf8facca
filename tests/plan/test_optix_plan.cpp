// What --accel optix decides, and what it refuses.
#include <gtest/gtest.h>

#include <map>

#include "app/options/option_list.h"
#include "common/error/error.h"
#include "common/plan/execution_plan.h"

namespace pt {
namespace {

using Choices = std::map<std::string, std::string>;

SceneProperties triangle_scene() {
  SceneProperties scene;
  scene.triangles = 1000, scene.bsdf_kinds = 1;
  return scene;
}

DeviceProperties optix_gpu() {
  DeviceProperties device;
  device.is_cuda = true, device.block_shared_bytes = 227 * 1024;
  return device;
}

ExecutionPlan optix_plan(const Choices& settings, const SceneProperties& scene = triangle_scene(),
                         const DeviceProperties& device = optix_gpu()) {
  Options options;
  options.accel = AccelKind::optix;
  for (const auto& [name, value] : settings) find_option(name).set(options, value);
  return plan_execution(options, scene, device);
}

std::string optix_refusal(const Choices& settings, const SceneProperties& scene = triangle_scene(),
                          const DeviceProperties& device = optix_gpu()) {
  try {
    optix_plan(settings, scene, device);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(OptixPlan, TracesTheQueuesOfWavesThatTheHostLaunches) {
  const ExecutionPlan plan = optix_plan({});
  EXPECT_TRUE(plan.traces_by_optix);
  EXPECT_EQ(plan.mode, Mode::wavefront);
  EXPECT_EQ(plan.accel, Accel::cwbvh);
  EXPECT_TRUE(plan.persistent_warps);
  EXPECT_FALSE(plan.uses_graph);
  EXPECT_EQ(plan.finish_paths, 0u);
  EXPECT_FALSE(plan.finishes_in_blocks);
  EXPECT_EQ(plan.optix_hits, OptixHits::custom);
  std::map<std::string, std::string> decided, reasons;
  for (const Decision& one : plan.decisions)
    decided[one.option] = one.value, reasons[one.option] = one.reason;
  EXPECT_EQ(decided["accel"], "optix");
  EXPECT_EQ(decided["optix-hits"], "custom");
  EXPECT_EQ(reasons["optix-hits"], "our test decides: hits are our trees'");
  EXPECT_EQ(decided["schedule"], "host");
  EXPECT_EQ(reasons["schedule"], "a launch of OptiX is not recorded in a graph");
}

std::map<std::string, Decision> decisions_of(const ExecutionPlan& plan) {
  std::map<std::string, Decision> decisions;
  for (const Decision& one : plan.decisions) decisions[one.option] = one;
  return decisions;
}

TEST(OptixPlan, RunsTheMegakernel) {
  const ExecutionPlan plan = optix_plan({{"mode", "megakernel"}});
  EXPECT_TRUE(plan.traces_by_optix);
  EXPECT_EQ(plan.mode, Mode::megakernel);
  EXPECT_EQ(plan.megakernel, MegakernelKind::loop);
  EXPECT_EQ(plan.accel, Accel::cwbvh);
  EXPECT_FALSE(plan.reorder);
  const auto decisions = decisions_of(plan);
  EXPECT_EQ(decisions.at("kernel").value, "loop");
  EXPECT_EQ(decisions.at("kernel").reason, "in OptiX's ray generation program");
  EXPECT_EQ(decisions.at("accel").value, "optix");
  EXPECT_EQ(decisions.at("optix-hits").value, "custom");
  SceneProperties masked = triangle_scene(), forest = triangle_scene(), both = triangle_scene();
  masked.has_masks = true, forest.instances = 20;
  both.has_masks = true, both.instances = 20;
  for (const SceneProperties& scene : {masked, forest, both})
    EXPECT_TRUE(optix_plan({{"mode", "megakernel"}}, scene).traces_by_optix);
}

TEST(OptixPlan, SaysWhetherThreadsAreReordered) {
  const char* const reorders_nothing = "; this GPU reorders nothing: RTX GPUs do, from Ada on";
  DeviceProperties ada = optix_gpu();
  ada.can_reorder = true;
  const auto reorder = [](const char* value, const DeviceProperties& device) {
    const ExecutionPlan plan =
        optix_plan({{"mode", "megakernel"}, {"reorder", value}}, triangle_scene(), device);
    const Decision decision = decisions_of(plan).at("reorder");
    EXPECT_EQ(plan.reorder, decision.value == "on");
    return decision.value + ": " + decision.reason;
  };
  EXPECT_EQ(reorder("on", ada), "on: asked for");
  EXPECT_EQ(reorder("off", ada), "off: not asked for");
  EXPECT_EQ(reorder("on", optix_gpu()), std::string("on: asked for") + reorders_nothing);
  EXPECT_EQ(reorder("off", optix_gpu()), std::string("off: not asked for") + reorders_nothing);
  EXPECT_EQ(decisions_of(optix_plan({})).count("reorder"), 0u);  // the wavefront has queues
}

TEST(OptixPlan, RefusesWhatItsMegakernelDoesNotKnow) {
  SceneProperties scene = triangle_scene();
  scene.name = "room";
  const auto refusal = [&](Choices settings, const SceneProperties& refused) {
    settings["mode"] = "megakernel";
    return optix_refusal(settings, refused);
  };
  SceneProperties media = scene;
  media.has_media = true;
  EXPECT_EQ(refusal({}, media),
            "--accel optix: its megakernel knows no media; scene 'room' has some, expected --mode "
            "wavefront");
  EXPECT_EQ(refusal({{"kernel", "vote"}}, scene),
            "--accel optix: its threads follow their paths; expected --kernel loop, not vote");
  EXPECT_EQ(refusal({{"block", "32x4"}}, scene),
            "--accel optix: OptiX chooses its blocks; expected no --block");
  EXPECT_EQ(refusal({{"counters", "on"}}, scene),
            "--accel optix: OptiX's kernels are not counted; expected no --counters");
  EXPECT_NE(refusal({{"branching", "reduced"}}, scene).find("expected --branching divergent"),
            std::string::npos);
  EXPECT_NE(refusal({{"path-bytes", "32"}}, scene), "");
}

TEST(OptixPlan, IsNeverChosenByItself) {
  for (const char* mode : {"auto", "wavefront", "megakernel"})
    EXPECT_FALSE(optix_plan({{"accel", "auto"}, {"mode", mode}}).traces_by_optix);
}

TEST(OptixPlan, TakesQuadsAsTrianglesSpheresAndInstances) {
  SceneProperties quads;
  quads.quads = 12, quads.is_primitive_only = true, quads.bsdf_kinds = 1;
  EXPECT_TRUE(optix_plan({}, quads).traces_by_optix);
  SceneProperties forest = triangle_scene();
  forest.instances = 20;
  EXPECT_TRUE(optix_plan({{"optix-hits", "built-in"}}, forest).traces_by_optix);
  SceneProperties spheres;
  spheres.spheres = 3, spheres.is_primitive_only = true, spheres.bsdf_kinds = 1;
  SceneProperties all = forest, misty = spheres;
  all.spheres = 3, all.has_masks = true, misty.has_media = true, misty.is_primitive_only = false;
  for (const char* mode : {"wavefront", "megakernel"}) {
    EXPECT_TRUE(optix_plan({{"mode", mode}}, spheres).traces_by_optix);
    EXPECT_TRUE(optix_plan({{"mode", mode}}, all).traces_by_optix);
  }
  EXPECT_TRUE(optix_plan({}, misty).persistent_warps);
}

TEST(OptixPlan, RefusesWhatItCannotTrace) {
  SceneProperties scene = triangle_scene();
  scene.name = "room";
  DeviceProperties cpu;
  cpu.threads = 4;
  EXPECT_EQ(optix_refusal({}, scene, cpu),
            "--accel optix: OptiX runs on NVIDIA's GPUs; expected --device cuda");
  EXPECT_EQ(optix_refusal({{"stages", "fused"}}, scene),
            "--accel optix: fused stages have no queue; expected --stages split");
  EXPECT_EQ(optix_refusal({{"persistent", "off"}}, scene),
            "--accel optix: whole queues are traced; expected --persistent on");
  EXPECT_EQ(optix_refusal({{"schedule", "graph"}}, scene),
            "--accel optix: a launch of OptiX is not recorded in a graph; expected --schedule "
            "host");
  EXPECT_EQ(optix_refusal({{"finish-paths", "7"}}, scene),
            "--accel optix: only waves have their rays traced by OptiX; expected --finish-paths "
            "0");
  EXPECT_EQ(optix_refusal({{"counters", "on"}}, scene),
            "--accel optix: OptiX's kernels are not counted; expected no --counters");
  EXPECT_NE(optix_refusal({{"compaction", "cub"}}, scene).find("--compaction atomic"),
            std::string::npos);
  SceneProperties masked = scene, open = scene;
  masked.has_masks = true;
  EXPECT_EQ(optix_refusal({}, masked), "");
  EXPECT_EQ(optix_refusal({{"optix-hits", "built-in"}}, masked),
            "--accel optix: only our programs judge masks; expected --optix-hits custom or "
            "any-hit");
  SceneProperties moving = scene;
  moving.has_motion = true;
  EXPECT_EQ(optix_refusal({}, moving),
            "--accel optix: OptiX traces what stands still; scene 'room' moves");
  masked.instances = 3;
  EXPECT_EQ(optix_refusal({}, masked), "");
  open.has_media = open.has_open_boundaries = true;
  EXPECT_NE(optix_refusal({}, open).find("scene 'room' has no kernel for it"), std::string::npos);
}

}  // namespace
}  // namespace pt
