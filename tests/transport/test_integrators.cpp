// An integrator is a type that the modes are handed: a second one, ambient occlusion, runs in all
// three without a line of theirs, gives the same bits in each, and the value that is known.
#include <gtest/gtest.h>

#include <numeric>

#include "common/scene/prepare/prepare_scene.h"
#include "megakernel/trace_path.h"
#include "wavefront/loop.h"
#include "wavefront/run_stage_cpu.h"

namespace pt {
namespace {

/// pbrt's AmbientOcclusionIntegrator: how much of the cosine-weighted hemisphere is free.
struct AmbientOcclusion {
  static constexpr float radius = 1e4f;

  template <Lighting>
  PT_HD static Color miss(const Scene&, const Vec3&, const PathState&, const PathLimits&) {
    return Color(0.0f);
  }

  template <class Traits, class Steps>
  PT_HD static Scattering surface(const Scene& scene, const Ray& ray, const Hit& hit,
                                  PathState& path, const PathLimits&, const Steps& steps) {
    const Vec4 u = steps.scatter();
    const Surface surface = surface_at<Traits>(scene, ray, hit);
    const bool front = dot(surface.point.normal, ray.direction) < 0.0f;
    const Frame frame = make_frame(front ? surface.point.normal : -surface.point.normal);
    const Vec3 wi = normalize(frame.to_world(sample_cosine_hemisphere(u.x, u.y)));
    Scattering result;
    result.shadow = {spawn_ray(surface.point, wi), radius, Color(1.0f)};
    ++path.shadow_rays;
    return result;
  }
};

using Kind = Traits<Accel::brute, Geometry::spheres_and_quads, Lighting::emitters, false, false,
                    AmbientOcclusion>;

constexpr std::uint32_t width = 8, height = 8, sample_count = 256;
constexpr PhiloxSource source{7};
constexpr PathLimits limits;

/// A floor, seen from above at a distance of 1 from an endless wall of height 2. The lamp far below
/// the floor makes it a scene with lights.
SceneData floor_and_wall() {
  SceneData scene;
  scene.materials = {make_diffuse(Color(0.5f)), make_diffuse(Color(0.5f), Color(1.0f))};
  scene.add_quad({-1e3f, 0, -1e3f}, {0, 0, 2e3f}, {2e3f, 0, 0}, 0);
  scene.add_quad({1, 0, -1e3f}, {0, 2, 0}, {0, 0, 2e3f}, 0);
  scene.add_sphere({0, -100, 0}, 1, 1);
  scene.camera.look_from = {0, 1, 0};
  scene.camera.look_at = {0, 0, 0};
  scene.camera.up = {0, 0, 1};
  scene.camera.fov_degrees = 0.5f;
  prepare_scene(scene);
  return scene;
}

class Integrators : public testing::Test {
 protected:
  using Samples = std::vector<Sample>;

  SampleBuffer buffer(Samples& samples) const {
    samples.assign(std::size_t{width} * height * sample_count, {});
    return {samples.data(), {0, 0, width, height}, 0, sample_count};
  }

  Samples serial() const {
    Samples result;
    const SampleBuffer batch = buffer(result);
    for (std::uint32_t i = 0; i < batch.path_count; ++i) {
      auto random = source.open(batch.id_of(i));
      PathState path;
      path.index = i;
      const Ray ray = generate_camera_path(view_, batch.id_of(i).pixel, random.draw(0));
      batch.store(path, follow_path<Kind>(view_, ray, path, Color(0.0f), limits, random, 0));
    }
    return result;
  }

  Samples megakernel() const {
    struct Work {
      std::uint32_t end, given = 0;
      bool any(bool value) const { return value; }
      bool next(std::uint32_t& path_index, bool wanted) {
        if (!wanted) return true;
        path_index = given;
        return given++ < end;
      }
    };
    Samples result;
    const SampleBuffer batch = buffer(result);
    Work work{batch.path_count};
    trace_paths<Kind, Branching::divergent>(view_, source, batch, limits, work);
    return result;
  }

  Samples wavefront(std::uint32_t finish_paths, std::uint32_t fused_rays = 0,
                    std::uint32_t slots = 1000) const;

  const SceneData data_ = floor_and_wall();
  const Scene view_ = host_view(data_, width, height);
};

/// What the waves need of a device.
struct Executor {
  const Scene& scene;
  WaveCounters& counters;
  std::uint32_t path_count, finish_paths, half_ring;
  bool more = true;

  static constexpr bool streams_shading = false;
  template <class>
  static constexpr bool traces_queues = false;
  static constexpr bool flies_queues = false;

  void compact(const CompactionRequest&) {}
  void order_surfaces(const SurfaceOrder& order) { order_surfaces_cpu(scene, order); }
  void begin_wave() { more = pt::begin_wave(counters, path_count, true, finish_paths, half_ring); }
  template <class Stage>
  void run(const Stage& stage, const StageQueues& queues) {
    run_stage_cpu(stage, scene, queues);
  }
};

/// `fused_rays`: of a path in a wave; 0: tracing and shading are split. A pool that holds the batch
/// has no queue of free slots, as on CUDA.
Integrators::Samples Integrators::wavefront(std::uint32_t finish_paths, std::uint32_t fused_rays,
                                            std::uint32_t slots) const {
  Samples result;
  const SampleBuffer batch = buffer(result);
  WaveCounters counters{};
  WaveBuffers b;
  b.policy.compaction = compaction_info(Compaction::atomic);
  b.counters = &counters;
  b.pool.slot_count = slots;
  b.slot_count = &b.pool.slot_count;
  b.policy.fused = fused_rays > 0, b.policy.wave_rays = fused_rays;
  b.reuses_slots = slots < batch.path_count;
  std::vector<std::shared_ptr<void>> arrays;
  const auto array = [&](auto* p, std::uint64_t count) {
    using T = std::remove_pointer_t<decltype(p)>;
    const auto memory = std::make_shared<std::vector<T>>(count);
    arrays.push_back(memory);
    return memory->data();
  };
  b.policy.parts = {.lights = !b.policy.fused, .hits = !b.policy.fused};
  b.pool.allocate_arrays(b.policy.parts, array);
  b.for_each_queue([&](auto*& queue, std::uint64_t capacity) { queue = array(queue, capacity); });
  if (b.reuses_slots) std::iota(b.queue(free_slot), b.queue(free_slot) + slots, 0u);
  *b.waiting(free_slot) = slots;

  Executor execute{view_, counters, batch.path_count, finish_paths, b.half_ring()};
  const StageContext<PhiloxSource> context{
      b.pool, batch, source, &counters, b.queue(StageId::intersect), limits, {}};
  for (bool starts = true; execute.more; starts = b.reuses_slots) {
    run_wave<Kind, Branching::divergent>(execute, b, context, starts);
  }
  pt::finish_paths<Kind>(execute, b, context);
  return result;
}

TEST_F(Integrators, AnotherOneGivesTheSameBitsInAllModes) {
  const Samples expected = serial();
  constexpr std::uint32_t all = width * height * sample_count;
  for (const Samples& samples :
       {megakernel(), wavefront(0), wavefront(1u << 20), wavefront(0, 0, all), wavefront(0, 1),
        wavefront(0, 2), wavefront(50, 1), wavefront(0, 1, 7), wavefront(0, 1, all),
        wavefront(0, 3, all), wavefront(1u << 20, 1, all)}) {
    ASSERT_EQ(samples.size(), expected.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      ASSERT_EQ(samples[i].radiance, expected[i].radiance) << "path " << i;
      ASSERT_EQ(samples[i].rays, expected[i].rays) << "path " << i;
    }
  }
}

// The wall's form factor as seen from the floor is (1 - d / sqrt(d^2 + h^2)) / 2.
TEST_F(Integrators, AmbientOcclusionBesideAWallIsKnown) {
  const Samples samples = serial();
  double sum = 0;
  for (const Sample& sample : samples) sum += sample.radiance.x;
  const double n = static_cast<double>(samples.size());
  const double free = 1.0 - 0.5 * (1.0 - 1.0 / std::sqrt(5.0));
  const double standard_error = std::sqrt(free * (1.0 - free) / n);
  // 0.002: the pixels lie within 0.004 of the point.
  EXPECT_NEAR(sum / n, free, 4.0 * standard_error + 0.002);
}

}  // namespace
}  // namespace pt
