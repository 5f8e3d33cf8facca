// The wavefront on the CPU. Each thread has a pool of its own, small enough to stay in its caches,
// and runs waves over it until the batch has no path left: threads share nothing but the number of
// the next path.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <numeric>

#include "common/accel/trace_cpu/ray_block.h"
#include "common/device/cpu/cpu_renderer.h"
#include "common/error/host_memory.h"
#include "common/options/option_names.h"
#include "wavefront/loop.h"
#include "wavefront/run_block_cpu.h"
#include "wavefront/run_stage_cpu.h"
#include "wavefront/shade_block_cpu.h"
#include "wavefront/wavefront.h"

namespace pt {
namespace {

/// The paths of a batch, handed out in runs of neighbours.
class PathRuns {
 public:
  explicit PathRuns(std::uint32_t path_count) : path_count_(path_count) {}

  bool is_empty() const { return next_.load(std::memory_order_relaxed) >= path_count_; }

  /// Takes up to `length` paths, from `first` on; how many they are.
  std::uint32_t take(std::uint32_t length, std::uint32_t& first) {
    const std::uint64_t begin =
        std::min(next_.fetch_add(length, std::memory_order_relaxed), path_count_);
    first = static_cast<std::uint32_t>(begin);
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(length, path_count_ - begin));
  }

  /// No path more is to be started.
  void end() { next_.store(path_count_, std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> next_{0};
  const std::uint64_t path_count_;
};

/// What a thread has of the pool.
struct PoolPart {
  std::uint32_t slot_count = 0;
  WaveCounters counters{};
  WaveBuffers buffers;
  StageTimer timer;
  std::vector<std::shared_ptr<void>> arrays;
  // One thread: work in this arena neither waits for other threads nor takes their work.
  tbb::task_arena arena{1};

  PoolPart(const WaveBuffers& common, std::uint32_t slots) : slot_count(slots), buffers(common) {
    buffers.slot_count = &slot_count;
    buffers.counters = &counters;
    buffers.pool.slot_count = slot_count;
    buffers.pool.allocate_arrays(buffers.policy.fields, [&](auto* p, std::uint64_t count) {
      return array<std::remove_pointer_t<decltype(p)>>(count);
    });
    buffers.for_each_queue([&](auto*& queue, std::uint64_t capacity) {
      queue = array<std::remove_pointer_t<std::remove_reference_t<decltype(queue)>>>(capacity);
    });
  }

  /// Before a batch: every slot is free, as the tags are after the one before.
  void reset() {
    counters = {};
    if (!buffers.policy.compaction.appends) return;
    std::uint32_t* const free = buffers.queue(free_slot);
    std::iota(free, free + slot_count, 0u);
    *buffers.waiting(free_slot) = slot_count;
  }

 private:
  // Zero-filled, so every slot is free.
  template <class T>
  T* array(std::uint64_t count) {
    arrays.push_back(
        std::shared_ptr<void>(new T[count]{}, [](void* p) { delete[] static_cast<T*>(p); }));
    return static_cast<T*>(arrays.back().get());
  }
};

class CpuExecutor {
 public:
  CpuExecutor(const Scene& scene, const ExecutionPlan& plan, PoolPart& part, PathRuns& runs,
              bool repeats, std::uint32_t finish_paths, bool has_open_boundaries)
      : scene_(scene),
        plan_(plan),
        part_(part),
        runs_(runs),
        repeats_(repeats),
        finish_paths_(finish_paths),
        has_open_boundaries_(has_open_boundaries) {}

  void compact(const CompactionRequest& request) {
    const TagPass pass = part_.buffers.policy.compaction.pass;
    if (pass == TagPass::none) return;
    part_.timer.time(to_string(StageId::compact), [&] { compact_cpu(pass, request); });
  }

  void begin_wave() {
    WaveCounters& c = part_.counters;
    const bool is_empty = c.waiting[queue_of<StageId::intersect>] == c.next_first_ray;
    const bool starts_paths = plan_.regenerate || is_empty;
    const std::uint32_t free = starts_paths ? c.waiting[queue_of<free_slot>] : 0;
    std::uint32_t left = 0;
    if (!repeats_) {
      // Every free slot gets a path as long as there are some. Where none is to start now, one that
      // could says that there are more.
      left = free > 0 ? runs_.take(free, c.next_path) : (runs_.is_empty() ? 0 : 1);
    }
    more_ = pt::begin_wave(c, c.next_path + left, starts_paths, finish_paths_,
                           part_.buffers.half_ring());
  }

  template <class Wave>
  void while_waves(Wave&& wave) {
    while (more_) wave();
  }

  void order_surfaces(const SurfaceOrder& order) {
    part_.timer.time(to_string(StageId::order_surfaces),
                     [&] { order_surfaces_cpu(scene_, order); });
  }

  static constexpr bool streams_shading = false;

  template <class Traits>
  static constexpr bool traces_queues = false;  // a thread is no warp
  static constexpr bool flies_queues = false;

  template <class Stage>
  void run(const Stage& stage, const StageQueues& queues) {
    if (*queues.count == 0) return;
    part_.timer.time(to_string(id_of(stage)), [&] {
      if constexpr (shades_in_blocks<Stage>) return shade_blocks_cpu(stage, scene_, queues);
      if constexpr (may_run_in_blocks<Stage>) {
        const BlockTraits traits = block_traits(stage, scene_);
        // With media a block's shadow rays end at the first surface.
        if (traces_blocks(traits) && !(traits.has_media && has_open_boundaries_))
          return run_blocks_cpu(stage, traits, stage.samples, scene_, queues);
      }
      run_stage_cpu(stage, scene_, queues);
    });
  }

 private:
  const Scene& scene_;
  const ExecutionPlan& plan_;
  PoolPart& part_;
  PathRuns& runs_;
  bool repeats_;  ///< the stages start paths themselves
  std::uint32_t finish_paths_;
  bool has_open_boundaries_;
  bool more_ = true;
};

class WavefrontCpu : public CpuRenderer {
 public:
  WavefrontCpu(const ExecutionPlan& plan, const SceneData& scene)
      : CpuRenderer(plan, scene), has_open_boundaries_(scene.properties.has_open_boundaries) {
    const std::uint64_t image_paths = std::uint64_t(plan.width) * std::uint64_t(plan.height) *
                                      static_cast<std::uint64_t>(plan.spp);
    const auto threads = static_cast<std::uint64_t>(this->threads());
    pool_size_ = plan.pool_size > 0 ? plan.pool_size : std::min(plan.pool_paths_max, image_paths);
    WaveBuffers common;
    common.policy = WavePolicy(plan, traits_, scene_, false);  // a thread takes no queue of flights
    common.all_slots = static_cast<std::uint32_t>(pool_size_);
    const std::uint64_t size_bytes = pool_size_ * (PathPool::bytes_per_slot(common.policy.fields) +
                                                   common.queue_bytes_per_slot());
    check_host_memory(size_bytes, fmt::format("a pool of {} paths (--pool-size)", pool_size_));
    note_memory("path pool and queues", size_bytes);
    const std::uint64_t count = std::min(threads, pool_size_);
    for (std::uint64_t i = 0; i < count; ++i) {
      common.first_slot = static_cast<std::uint32_t>(pool_size_ * i / count);
      const std::uint64_t slots = pool_size_ * (i + 1) / count - common.first_slot;
      parts_.push_back(std::make_unique<PoolPart>(common, static_cast<std::uint32_t>(slots)));
    }
  }

 private:
  void trace_batch(const SampleBuffer& batch) override {
    with_random_source(batch, [&](const auto& source) {
      using Source = std::remove_cvref_t<decltype(source)>;
      dispatch_traits(CpuKindsWith<Source>{}, traits_, [&](auto traits) {
        dispatch_branching<false, decltype(traits), Source, SceneMemory::global,
                           KernelBody::stages>(plan_.branching, [&](auto branching) {
          run_parts<decltype(traits), branching()>(source, batch);
        });
      });
    });
  }

  template <class Traits, Branching branching, class Source>
  void run_parts(const Source& source, const SampleBuffer& batch) {
    PathRuns runs(batch.path_count);
    tbb::parallel_for(std::size_t{0}, parts_.size(), [&](std::size_t i) {
      PoolPart& part = *parts_[i];
      part.arena.execute([&] { run_waves<Traits, branching>(source, batch, part, runs); });
    });
    for (const auto& part : parts_) {
      waves_ += part->counters.waves;
      timer_.add(part->timer, 1.0 / static_cast<double>(parts_.size()));
      part->timer.reset();
    }
  }

  template <class Traits, Branching branching, class Source>
  void run_waves(const Source& source, const SampleBuffer& batch, PoolPart& part,
                 PathRuns& runs) const {
    part.reset();
    const WaveBuffers& buffers = part.buffers;
    const bool repeats = this->supply().has_chains();
    const StageContext<Source> context{buffers.pool,
                                       batch,
                                       source,
                                       &part.counters,
                                       buffers.queue(StageId::intersect),
                                       this->path_settings_,
                                       this->supply()};
    const std::uint64_t most_left = repeats ? 0 : std::uint64_t{plan_.finish_paths} / parts_.size();
    CpuExecutor execute(scene_, plan_, part, runs, repeats, static_cast<std::uint32_t>(most_left),
                        has_open_boundaries_);
    const auto wave = [&](bool starts_paths) {
      run_wave<Traits, branching>(execute, buffers, context, starts_paths);
      if (is_cancelled()) runs.end();
    };
    run_all_waves(execute, buffers, repeats, wave,
                  [&] { finish_paths<Traits>(execute, buffers, context); });
  }

  std::vector<std::unique_ptr<PoolPart>> parts_;
  const bool has_open_boundaries_;
};

}  // namespace

std::unique_ptr<Renderer> make_wavefront_cpu(const ExecutionPlan& plan, const SceneData& scene) {
  return std::make_unique<WavefrontCpu>(plan, scene);
}

}  // namespace pt
