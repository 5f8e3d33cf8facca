// The megakernel that OptiX runs, on the CPU by a library of the tests' own: one image with the
// serial mode, bit for bit.
#include "accel/emulated_optix.h"
#include "common/accel/trace_optix/optix_tracer.h"
#include "common/device/cpu/cpu_renderer.h"
#include "megakernel/optix_paths.h"
#include "mode_cases.h"
#include "scene/lit_room.h"
#include "scene/masked_room.h"
#include "scene/material_room.h"
#include "scene/mixed_scene.h"

namespace pt {
namespace {

const OptixPathParams* path_params = nullptr;

struct PathApi : EmulatedApi {
  static const OptixPathParams& params() { return *path_params; }
  static const Scene& world() { return path_params->world; }
  static MaskView masks() { return MaskView(world()); }
};

OptixPrograms path_programs() {
  OptixPrograms programs = hit_programs<PathApi, ClosestJudge<PathApi>, AnyJudge<PathApi>>(
      []() -> const OptixScene& { return path_params->scene; });
  programs["__raygen__paths"] = [] { trace_launched_paths<PathApi>(); };
  return programs;
}

class OptixPathsCpu : public CpuRenderer {
 public:
  OptixPathsCpu(const ExecutionPlan& plan, const SceneData& scene)
      : CpuRenderer(plan, scene),
        choices_{plan.optix_hits, plan.reorder},
        tracer_(optix_memory_, scene_, plan.optix_hits, module()) {}

 private:
  OptixModule module() const {
    OptixModule module = optix_path_module(choices_);
    module.code = "code";
    return module;
  }

  void trace_batch(const SampleBuffer& batch) override {
    launch_paths(tracer_, plan_.work,
                 {.choices = choices_,
                  .world = scene_,
                  .source = sampler_source_of(plan_),
                  .samples = batch,
                  .settings = path_settings_});
  }

  HostOptixMemory optix_memory_;
  OptixPathChoices choices_;
  OptixTracer tracer_;
};

class OptixPaths : public testing::TestWithParam<OptixHits> {
 protected:
  OptixPaths() {
    fake_.emulate(path_programs(), [this](const void* params) {
      path_params = static_cast<const OptixPathParams*>(params);
      ++launches_;
    });
  }

  void expect_equal(const SceneData& scene, const Settings& more = {}) {
    const Options options = with(with(Options(), {{"device", "cpu"},
                                                  {"mode", "megakernel"},
                                                  {"accel", "cwbvh"},
                                                  {"width", "9"},
                                                  {"height", "7"},
                                                  {"spp", "2"},
                                                  {"max-depth", "5"}}),
                                 more);
    const DeviceInfo device = choose_device(options.device);
    SceneData prepared = scene;
    prepare_scene_for(prepared, options, device);
    const Rendered expected =
        take_image(*make_renderer(with(options, {{"mode", "serial"}}), prepared, device));
    expect_plausible(expected, options);
    for (const bool reorders : {false, true}) expect_equal(expected, options, prepared, reorders);
  }

  void expect_equal(const Rendered& expected, const Options& options, const SceneData& scene,
                    bool reorders) {
    SCOPED_TRACE(reorders ? "reordered" : "in order");
    ExecutionPlan plan = plan_for(options, scene, choose_device(options.device));
    plan.optix_hits = GetParam(), plan.reorder = reorders;
    OptixPathsCpu paths(plan, scene);
    launches_ = 0;
    const Rendered found = take_image(paths);
    if (GetParam() == OptixHits::built_in) {
      EXPECT_LE(differing_pixels(found.image, expected.image), 9u * 7 / 5);
    } else {
      expect_same(found, expected);
    }
    EXPECT_GT(launches_, 0);
    const OptixPathChoices choices{GetParam(), reorders};
    EXPECT_EQ(fake_->constants,
              std::string(reinterpret_cast<const char*>(&choices), sizeof choices));
    reorders_ = EmulatedApi::state().reorders;
    traversals_ = EmulatedApi::state().traversals;
    EXPECT_EQ(!reorders_.empty(), reorders && traversals_ > 0);
  }

  UsedFakeOptix fake_;
  int launches_ = 0;
  std::map<std::uint32_t, int> reorders_;  ///< of the last launch, by key
  int traversals_ = 0;                     ///< likewise
};
INSTANTIATE_TEST_SUITE_P(Hits, OptixPaths,
                         testing::Values(OptixHits::custom, OptixHits::any_hit,
                                         OptixHits::built_in),
                         hits_name);

SceneData made(const std::string& scene) {
  return build_scene(with(Options(), {{"scene", scene}, {"kernel-set", "general"}}));
}

TEST_P(OptixPaths, OfTrianglesGiveTheSerialImage) {
  for (const char* work : {"persistent", "pixel", "sample"}) {
    SCOPED_TRACE(work);
    expect_equal(made("statue:1K"), {{"work", work}});
  }
}
TEST_P(OptixPaths, OfInstancesGiveTheSerialImage) { expect_equal(made("instances:4")); }

TEST_P(OptixPaths, OfSpheresGiveTheSerialImage) {
  expect_equal(made("spheres"), {{"kernel-set", "general"}});
}

TEST_P(OptixPaths, OfAllShapesGiveTheSerialImage) {
  for (const SceneData& scene : {mixed_scene(), lit_room()}) expect_equal(scene);
}

// Beyond OptixReach, a camera's rays pass through our own tree where our test decides.
TEST_P(OptixPaths, FromFarAwayGiveTheSerialImage) {
  const Settings far{{"look-from", "400,300,500"}, {"look-at", "0,0,0"}, {"fov", "0.6"}};
  expect_equal(made("statue:1K"), far);
  const int all = traversals_;
  Settings camera_alone = far;
  camera_alone.push_back({"max-depth", "1"}), camera_alone.push_back({"nee", "off"});
  expect_equal(made("statue:1K"), camera_alone);
  EXPECT_GT(all, 9);
  EXPECT_EQ(traversals_ == 0, GetParam() != OptixHits::built_in);
  SceneData shapes = mixed_scene();
  shapes.camera = {{900, 500, 900}, {0, 0, 0}, {0, 1, 0}, 3.0f, 0.0f, 1000.0f};
  expect_equal(shapes);
  expect_equal(shapes, {{"max-depth", "1"}, {"nee", "off"}});
  EXPECT_EQ(traversals_ == 0, GetParam() != OptixHits::built_in);
}

TEST_P(OptixPaths, WithRouletteGiveTheSerialImage) {
  expect_equal(made("boxes"), {{"rr", "2"}, {"sampler", "sobol"}, {"max-depth", "9"}});
}

TEST_P(OptixPaths, WithMasksGiveTheSerialImage) {
  if (GetParam() == OptixHits::built_in) GTEST_SKIP() << "masks are judged by our programs alone";
  SceneData spheres = limited_room();
  add_spheres(spheres);
  for (const SceneData& scene : {masked_room(), limited_room(), masked_forest(), spheres})
    expect_equal(scene);
}

// By what they hit: nothing, or one of the room's BSDFs; OptiX knows no BSDF.
TEST_P(OptixPaths, AreReorderedByTheirBsdfs) {
  expect_equal(material_room(false));
  if (GetParam() == OptixHits::built_in) {
    EXPECT_EQ(reorders_.size(), 1u);
    EXPECT_EQ(reorders_.begin()->first, 0u);
  } else {
    EXPECT_GT(reorders_.size(), 3u);
  }
}

}  // namespace
}  // namespace pt
