// Reading the stage clock: device code.
#pragma once

#include "common/device/cuda/stage_clock.h"

namespace pt {

/// To be called by one thread of a kernel when it starts: `id` runs now.
__device__ inline void stamp(StageClock* clock, StageId id) {
  std::uint64_t now;
  asm volatile("mov.u64 %0, %globaltimer;" : "=l"(now));
  clock->time_ns[static_cast<int>(clock->running)] += now - clock->last_ns;
  ++clock->launches[static_cast<int>(id)];
  clock->last_ns = now;
  clock->running = id;
}

__device__ inline void stamp_first_thread(StageClock* clock, StageId id) {
  if ((blockIdx.x | blockIdx.y | blockIdx.z | threadIdx.x | threadIdx.y) == 0) stamp(clock, id);
}

}  // namespace pt
