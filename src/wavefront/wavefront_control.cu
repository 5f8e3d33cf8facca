// What happens between waves, and after the last one.
#include "common/device/cuda/stage_stamp.cuh"
#include "wavefront/wavefront_enqueue.cuh"

namespace pt {
namespace {

/// The decision between two waves, taken on the device. `loop` is the graph's conditional handle,
/// 0 outside of a graph.
__global__ void begin_wave_kernel(WaveCounters* counters, std::uint32_t path_count, bool regenerate,
                                  std::uint32_t finish_paths, std::uint32_t half,
                                  cudaGraphConditionalHandle loop, StageClock* clock) {
  stamp(clock, StageId::begin_wave);
  const bool more = pt::begin_wave(*counters, path_count, regenerate, finish_paths, half);
  if (loop != 0) cudaGraphSetConditional(loop, more ? 1 : 0);
}

}  // namespace

void WavefrontCuda::begin_wave() {
  const std::uint32_t finish_paths = supply().has_chains() ? 0 : finish_paths_;
  launch("begin_wave", begin_wave_kernel, 1, 1, 0, buffers_.counters, path_count_, plan_.regenerate,
         finish_paths, buffers_.half_ring(), loop_, clock());
}

/// The last paths, followed to their ends by block-local wavefronts.
void WavefrontCuda::finish_in_blocks(const SampleBuffer& batch) {
  if (host_counters_->finish == 0) return;
  const BegunPaths paths = blocks_->place(host_counters_->finish);
  const StageQueues queues =
      buffers_.stage_queues(StageId::hand_over, &buffers_.counters->finish, nullptr);
  if (has_carrying_kernels && plan_.path_bytes > 0) {
    run(HandOver<has_carrying_kernels>{buffers_.pool, batch, paths}, queues);
  } else {
    run(HandOver<false>{buffers_.pool, batch, paths}, queues);
  }
  blocks_->finish(scene_, batch, sampler_source_of(plan_), path_settings_, StageId::finish, paths);
}

}  // namespace pt
