// The wavefront on the CPU: stages are parallel loops over oneTBB.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "common/device/cpu_renderer.h"
#include "common/render/option_names.h"
#include "common/scene/prepare_materials.h"
#include "wavefront/run_stage_cpu.h"

namespace pt {
namespace {

// Enough paths for every thread of a large machine, few enough to stay in its caches.
constexpr std::uint64_t auto_pool_size = std::uint64_t{1} << 16;

class CpuExecutor {
 public:
  CpuExecutor(const Scene& scene, const Options& options, StageTimer& timer, WaveCounters& counters,
              std::uint32_t path_count, bool of_chains, std::uint32_t half_ring)
      : scene_(scene),
        options_(options),
        timer_(timer),
        counters_(counters),
        path_count_(of_chains ? 0 : path_count),
        finish_paths_(of_chains ? 0 : static_cast<std::uint32_t>(options.finish_paths)),
        half_ring_(half_ring) {}

  void compact(const CompactionRequest& request) {
    const TagPass pass = compaction_info(options_.compaction).pass;
    if (pass == TagPass::none) return;
    timer_.time(to_string(StageId::compact), [&] { compact_cpu(pass, request); });
  }

  void begin_wave() {
    more_ = pt::begin_wave(counters_, path_count_, options_.regenerate, finish_paths_, half_ring_);
  }

  bool more() const { return more_; }

  void order_surfaces(const SurfaceOrder& order) {
    timer_.time(to_string(StageId::order_surfaces), [&] { order_surfaces_cpu(scene_, order); });
  }

  // They would take minutes to compile and gain nothing where threads do not run in warps.
  static constexpr bool kinds_have_kernels = false;

  template <class Traits>
  static constexpr bool traces_queues = false;  // a thread is no warp

  template <class Stage>
  void run(const Stage& stage, const StageQueues& queues) {
    if (*queues.count == 0) return;
    timer_.time(to_string(id_of(stage)), [&] { run_stage_cpu(stage, scene_, queues); });
  }

 private:
  const Scene& scene_;
  const Options& options_;
  StageTimer& timer_;
  WaveCounters& counters_;
  std::uint32_t path_count_, finish_paths_, half_ring_;
  bool more_ = true;
};

class WavefrontCpu : public CpuRenderer {
 public:
  WavefrontCpu(const Options& options, const SceneData& scene)
      : CpuRenderer(options, scene, options.threads) {
    const std::uint64_t image_paths = std::uint64_t(options.width) * std::uint64_t(options.height) *
                                      static_cast<std::uint64_t>(options.spp);
    pool_size_ = options.pool_size > 0 ? options.pool_size : std::min(auto_pool_size, image_paths);
    buffers_.compaction = compaction_info(options_.compaction);
    const bool fused = fuses_stages(options, traits_);
    buffers_.fused = fused;
    buffers_.wave_rays = static_cast<std::uint32_t>(options.wave_rays);
    stages_ = to_string(fused ? Stages::fused : Stages::split);
    buffers_.shades_by_kind = options.shade == Shade::material && !fused;
    buffers_.orders_surfaces = (buffers_.compaction.orders && !fused) || buffers_.shades_by_kind;
    buffers_.kinds = kinds_of(scene);
    buffers_.only_triangles = scene_.has_only_triangles();
    const PathPool::Parts parts = {traits_.has_lights() && !fused,
                                   traits_.geometry == Geometry::mixed,
                                   !buffers_.compaction.appends,
                                   scene_.light_selector.has_tree(),
                                   options.layout,
                                   !fused};
    const std::uint64_t size_bytes =
        pool_size_ * (PathPool::bytes_per_slot(parts) + buffers_.queue_bytes_per_slot());
    check_host_memory(size_bytes, fmt::format("a pool of {} paths (--pool-size)", pool_size_));
    note_memory("path pool and queues", size_bytes);
    allocate(parts);
  }

 private:
  void allocate(const PathPool::Parts& parts) {
    PathPool& pool = buffers_.pool;
    slot_count_ = pool.slot_count = static_cast<std::uint32_t>(pool_size_);
    buffers_.slot_count = &slot_count_;
    buffers_.counters = &counters_;
    pool.allocate_arrays(parts, [&](auto* p, std::uint64_t count) {
      return array<std::remove_pointer_t<decltype(p)>>(count);
    });
    buffers_.for_each_queue(parts.lights, [&](auto*& queue, std::uint64_t places) {
      queue = array<std::remove_pointer_t<std::remove_reference_t<decltype(queue)>>>(places);
    });
  }

  // Zero-filled, so every slot is free.
  template <class T>
  T* array(std::uint64_t count) {
    arrays_.push_back(
        std::shared_ptr<void>(new T[count]{}, [](void* p) { delete[] static_cast<T*>(p); }));
    return static_cast<T*>(arrays_.back().get());
  }

  void trace_batch(const SampleBuffer& batch) override {
    with_random_source(batch, [&](const auto& source) {
      using Source = std::remove_cvref_t<decltype(source)>;
      dispatch_traits(KindsWith<Source, CpuTriangleSceneKinds>{}, traits_, options_.integrator,
                      [&](auto traits) {
                        dispatch_branching<decltype(traits)>(
                            options_.branching, [&](auto branching) {
                              run_waves<decltype(traits), branching()>(source, batch);
                            });
                      });
    });
  }

  template <class Traits, Branching branching, class Source>
  void run_waves(const Source& source, const SampleBuffer& batch) {
    counters_ = {};
    if (buffers_.compaction.appends) {  // every slot begins in the queue of the free ones
      std::uint32_t* free = buffers_.queue(free_slot);
      std::iota(free, free + slot_count_, 0u);
      *buffers_.waiting(free_slot) = slot_count_;
    }
    const StageContext<Source> context{
        buffers_.pool, batch,   source, &counters_, buffers_.queue(StageId::intersect),
        limits_,       chains()};
    CpuExecutor execute(scene_, options_, timer_, counters_, batch.path_count, chains() != nullptr,
                        buffers_.half_ring());
    while (execute.more()) run_wave<Traits, branching>(execute, buffers_, context);
    if (chains() == nullptr) run_finish<Traits>(execute, buffers_, context);
    waves_ += counters_.waves;
  }

  std::uint32_t slot_count_ = 0;
  WaveCounters counters_{};
  WaveBuffers buffers_;
  std::vector<std::shared_ptr<void>> arrays_;
};

}  // namespace

std::unique_ptr<Renderer> make_wavefront_cpu(const Options& options, const SceneData& scene) {
  return std::make_unique<WavefrontCpu>(options, scene);
}

}  // namespace pt
