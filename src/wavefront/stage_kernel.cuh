// The kernel around a stage: threads take the slots of its queue in turn.
#pragma once

#include "common/device/scene_storage.cuh"
#include "common/device/stage_stamp.cuh"
#include "wavefront/wavefront.h"

namespace pt {

/// The queue's length is read on the device, so the grid has a fixed size and loops.
template <class Stage, SceneMemory memory>
__global__ void stage_kernel(const __grid_constant__ SceneStorage<memory> storage,
                             const __grid_constant__ Stage stage, StageQueue queue,
                             StageClock* clock) {
  stamp_first_thread(clock, static_cast<ClockId>(Stage::id));
  const std::uint32_t count = *queue.count;
  const std::uint32_t first = blockIdx.x * blockDim.x;
  if (first >= count) return;
  const Scene scene = storage.bind();
  for (std::uint32_t i = first + threadIdx.x; i < count; i += gridDim.x * blockDim.x) {
    const std::uint32_t slot = queue.slots == nullptr ? i : queue.slots[i];
    if (queue.slots == nullptr && queue.tags[slot] != Stage::tag) continue;
    stage(scene, slot, i);
  }
}

/// The decision between two waves, taken on the device. `loop` is the graph's conditional handle,
/// 0 outside of a graph.
static __global__ void begin_wave_kernel(WaveCounters* counters, std::uint32_t path_count,
                                         bool regenerate, cudaGraphConditionalHandle loop,
                                         StageClock* clock) {
  stamp(clock, ClockId::begin_wave);
  const bool more = begin_wave(*counters, path_count, regenerate);
  if (loop != 0) cudaGraphSetConditional(loop, more ? 1 : 0);
}

}  // namespace pt
