// One wave as kernel launches: the Executor of run_wave on CUDA.
#include "common/device/curand_state.cuh"
#include "wavefront/stage_kernel.cuh"
#include "wavefront/wavefront_cuda.h"

namespace pt {
namespace {

/// The decision between two waves, taken on the device. `loop` is the graph's conditional handle,
/// 0 outside of a graph.
__global__ void begin_wave_kernel(WaveCounters* counters, std::uint32_t path_count, bool regenerate,
                                  std::uint32_t finish_paths, cudaGraphConditionalHandle loop,
                                  StageClock* clock) {
  stamp(clock, ClockId::begin_wave);
  const bool more = pt::begin_wave(*counters, path_count, regenerate, finish_paths);
  if (loop != 0) cudaGraphSetConditional(loop, more ? 1 : 0);
}

}  // namespace

void WavefrontCuda::begin_wave() {
  launch("begin_wave", begin_wave_kernel, 1, 1, 0, buffers_.counters, path_count_,
         options_.regenerate, static_cast<std::uint32_t>(options_.finish_paths), loop_, clock());
}

template <class Stage>
void WavefrontCuda::run(const Stage& stage, const StageQueues& queues) {
  const int block = options_.stage_block[static_cast<int>(Stage::id)];
  const auto launch_with = [&](const auto& storage, std::size_t shared_bytes) {
    using Storage = std::remove_cvref_t<decltype(storage)>;
    constexpr auto kernel = stage_kernel<Stage, Storage::memory>;
    const std::uint32_t blocks =
        (buffers_.pool.slot_count + static_cast<std::uint32_t>(block) - 1) / block;
    const std::uint32_t resident =
        resident_blocks(reinterpret_cast<const void*>(kernel), block, shared_bytes);
    launch(clock_name(static_cast<ClockId>(Stage::id)), kernel,
           blocks < resident ? blocks : resident, block, shared_bytes, storage, stage, queues,
           clock());
  };
  // Only these kernels read the spheres again and again.
  if constexpr (Stage::scans_spheres) {
    with_scene_storage(launch_with);
  } else {
    launch_with(SceneStorage<SceneMemory::global>{scene_}, std::size_t{0});
  }
}

template <class Function>
void WavefrontCuda::with_stages(const SampleBuffer& batch, Function&& function) {
  with_random_source([&](const auto& source) {
    using Source = std::remove_cvref_t<decltype(source)>;
    const StageContext<Source> context{buffers_.pool,
                                       batch,
                                       source,
                                       buffers_.counters,
                                       buffers_.queue(QueueId::intersect),
                                       limits_};
    dispatch_traits(traits_, [&](auto traits) {
      dispatch_branching<decltype(traits)>(options_.branching,
                         [&](auto branching) { function(traits, branching, context); });
    });
  });
}

void WavefrontCuda::enqueue_wave(const SampleBuffer& batch, cudaGraphConditionalHandle loop,
                                 bool starts_paths) {
  path_count_ = batch.path_count;
  loop_ = loop;
  with_stages(batch, [&](auto traits, auto branching, const auto& context) {
    run_wave<decltype(traits), decltype(branching)::value>(*this, buffers_, context, starts_paths);
  });
}

void WavefrontCuda::enqueue_finish(const SampleBuffer& batch) {
  with_stages(batch, [&](auto traits, auto branching, const auto& context) {
    run_finish<decltype(traits), decltype(branching)::value>(*this, buffers_, context);
  });
}

}  // namespace pt
