// The wavefront whose rays OptiX traces, on the CPU by a library of the tests' own: one image with
// the serial mode, bit for bit.
#include <numeric>

#include "accel/emulated_optix.h"
#include "common/accel/trace_optix/optix_tracer.h"
#include "common/device/cpu/cpu_renderer.h"
#include "medium/filled_glasses.h"
#include "mode_cases.h"
#include "scene/lit_room.h"
#include "scene/masked_room.h"
#include "scene/mixed_scene.h"
#include "wavefront/loop.h"
#include "wavefront/optix/optix_queue.h"
#include "wavefront/run_stage_cpu.h"

namespace pt {
namespace {

const OptixQueueParams* queue_params = nullptr;

struct QueueApi : EmulatedApi {
  static const Scene& world() { return queue_params->world; }
  static MaskView masks() { return MaskView(world()); }
};

template <OptixHits hits>
void add_ray_generation(OptixPrograms& programs, const std::string& name) {
  programs["__raygen__closest_" + name] = [] { trace_queued_paths<QueueApi, hits>(*queue_params); };
  programs["__raygen__any_" + name] = [] {
    trace_queued_shadow_rays<QueueApi, hits>(*queue_params);
  };
}

OptixPrograms queue_programs() {
  OptixPrograms programs = hit_programs<QueueApi, ClosestJudge<QueueApi>, AnyJudge<QueueApi>>(
      []() -> const OptixScene& { return queue_params->scene; });
  add_ray_generation<OptixHits::custom>(programs, "custom");
  add_ray_generation<OptixHits::any_hit>(programs, "any_hit");
  add_ray_generation<OptixHits::built_in>(programs, "built_in");
  return programs;
}

/// One pool for all threads; OptiX traces its queues.
class OptixWaves : public CpuRenderer {
 public:
  OptixWaves(const ExecutionPlan& plan, const SceneData& scene, std::uint32_t slots)
      : CpuRenderer(plan, scene),
        has_masks_(scene.properties.has_masks),
        tracer_(optix_memory_, scene_, plan.optix_hits, {"code", sizeof(OptixQueueParams)}) {
    buffers_.policy = WavePolicy(plan, traits_, scene_, false);
    buffers_.pool.slot_count = buffers_.all_slots = slots;
    buffers_.counters = &counters_;
    buffers_.slot_count = &buffers_.pool.slot_count;
    buffers_.pool.allocate_arrays(buffers_.policy.fields, [&](auto* p, std::uint64_t count) {
      return array<std::remove_pointer_t<decltype(p)>>(count);
    });
    buffers_.for_each_queue([&](auto*& queue, std::uint64_t capacity) {
      queue = array<std::remove_pointer_t<std::remove_reference_t<decltype(queue)>>>(capacity);
    });
  }

  // The Executor of run_wave:
  void compact(const CompactionRequest&) {}
  void order_surfaces(const SurfaceOrder&) {}
  void begin_wave() { more_ = pt::begin_wave(counters_, path_count_, true, 0); }
  static constexpr bool streams_shading = false;
  template <class Stage>
  void run(const Stage& stage, const StageQueues& queues) {
    run_stage_cpu(stage, scene_, queues);
  }
  template <class Traits>
  static constexpr bool traces_queues = true;
  bool traces_queues_here() const { return true; }
  void trace_queue(const StageQueues& queues, const SampleBuffer& samples) {
    trace(OptixPipeline::closest, queues, samples);
  }
  void trace_shadow_queue(const StageQueues& queues, const SampleBuffer& samples) {
    trace(OptixPipeline::any, queues, samples);
  }
  static constexpr bool flies_queues = false;
  template <class Wave>
  void while_waves(Wave&& wave) {
    while (more_) wave();
  }

 private:
  void trace(OptixPipeline::Launch kind, const StageQueues& queues, const SampleBuffer& samples) {
    trace_by_optix(tracer_, kind,
                   {.world = scene_,
                    .has_masks = has_masks_,
                    .pool = buffers_.pool,
                    .slots = queues.slots,
                    .count = queues.count,
                    .samples = samples});
  }

  void trace_batch(const SampleBuffer& batch) override {
    path_count_ = batch.path_count;
    counters_ = {};
    std::uint32_t* const free = buffers_.queue(free_slot);
    std::iota(free, free + buffers_.pool.slot_count, 0u);
    *buffers_.waiting(free_slot) = buffers_.pool.slot_count;
    const SamplerSource source = sampler_source_of(plan_);
    const StageContext<SamplerSource> context{
        buffers_.pool,  batch,   source, &counters_, buffers_.queue(StageId::intersect),
        path_settings_, supply()};
    more_ = true;
    dispatch_traits(CpuKindsWith<SamplerSource>{}, traits_, [&](auto traits) {
      run_all_waves(
          *this, buffers_, false,
          [&](bool starts_paths) {
            run_wave<decltype(traits), Branching::divergent>(*this, buffers_, context,
                                                             starts_paths);
          },
          [] {});
    });
  }

  template <class T>
  T* array(std::uint64_t count) {
    arrays_.push_back(
        std::shared_ptr<void>(new T[count]{}, [](void* p) { delete[] static_cast<T*>(p); }));
    return static_cast<T*>(arrays_.back().get());
  }

  HostOptixMemory optix_memory_;
  bool has_masks_;
  OptixTracer tracer_;
  WaveCounters counters_{};
  WaveBuffers buffers_;
  std::vector<std::shared_ptr<void>> arrays_;
  std::uint32_t path_count_ = 0;
  bool more_ = true;
};

class OptixWavesOf : public testing::TestWithParam<OptixHits> {
 protected:
  OptixWavesOf() {
    fake_.emulate(queue_programs(), [](const void* params) {
      queue_params = static_cast<const OptixQueueParams*>(params);
    });
  }

  void expect_equal(const SceneData& scene, const Settings& more = {}) {
    const Options options = with(Options(), {{"device", "cpu"},
                                             {"mode", "wavefront"},
                                             {"accel", "cwbvh"},
                                             {"width", "12"},
                                             {"height", "9"},
                                             {"spp", "2"},
                                             {"max-depth", "5"},
                                             {"finish-paths", "0"}});
    const Options own = with(options, more);
    const DeviceInfo device = choose_device(own.device);
    SceneData prepared = scene;
    prepare_scene_for(prepared, own, device);
    const Rendered expected =
        take_image(*make_renderer(with(own, {{"mode", "serial"}}), prepared, device));
    expect_plausible(expected, own);
    ExecutionPlan plan = plan_for(own, prepared, device);
    plan.optix_hits = GetParam();
    OptixWaves waves(plan, prepared, 333);
    const Rendered found = take_image(waves);
    if (GetParam() == OptixHits::built_in) {
      EXPECT_LE(differing_pixels(found.image, expected.image), 12u * 9 / 5);
    } else {
      expect_same(found, expected);
    }
    EXPECT_GT(std::ranges::count(fake_->calls, "launch"), 4);
  }

  UsedFakeOptix fake_;
};
INSTANTIATE_TEST_SUITE_P(Hits, OptixWavesOf,
                         testing::Values(OptixHits::custom, OptixHits::any_hit,
                                         OptixHits::built_in),
                         hits_name);

SceneData made(const std::string& scene) {
  return build_scene(with(Options(), {{"scene", scene}, {"kernel-set", "general"}}));
}

TEST_P(OptixWavesOf, TrianglesGiveTheSerialImage) { expect_equal(made("statue:1K")); }
TEST_P(OptixWavesOf, InstancesGiveTheSerialImage) { expect_equal(made("instances:4")); }

TEST_P(OptixWavesOf, SpheresGiveTheSerialImage) {
  expect_equal(made("spheres"), {{"kernel-set", "general"}});
}

TEST_P(OptixWavesOf, AllShapesGiveTheSerialImage) {
  for (const SceneData& scene : {mixed_scene(), lit_room()}) expect_equal(scene);
}

TEST_P(OptixWavesOf, MediaGiveTheSerialImage) {
  SceneData spheres = filled_glasses(false);
  add_spheres(spheres);
  for (const SceneData& scene : {filled_glasses(false), spheres}) expect_equal(scene);
}

TEST_P(OptixWavesOf, MasksGiveTheSerialImage) {
  if (GetParam() == OptixHits::built_in) GTEST_SKIP() << "masks are judged by our programs alone";
  SceneData spheres = limited_room();
  add_spheres(spheres);
  for (const SceneData& scene :
       {masked_room(), limited_room(), masked_forest(), spheres, filled_glasses(true)})
    expect_equal(scene);
}

}  // namespace
}  // namespace pt
