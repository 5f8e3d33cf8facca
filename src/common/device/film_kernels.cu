#include "common/device/curand_state.cuh"
#include "common/device/film_kernels.h"
#include "common/device/stage_stamp.cuh"

namespace pt {

std::size_t random_state_bytes() { return sizeof(CurandState); }

/// The paper's render_init: one generator state per path.
__global__ void render_init(CurandState* states, SampleBuffer batch, std::uint64_t seed,
                            StageClock* clock) {
  stamp_first_thread(clock, ClockId::render_init);
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= batch.path_count) return;
  const PathId id = batch.id_of(i);
  curand_init(xorwow_seed(seed, id), 0, 0, &states[i].state);
}

__global__ void accumulate_film(FilmPixel* film, SampleBuffer batch, PathTally* tally,
                                StageClock* clock) {
  stamp_first_thread(clock, ClockId::accumulate);
  __shared__ std::uint32_t lengths[path_length_bins];
  for (int i = threadIdx.x; i < path_length_bins; i += blockDim.x) lengths[i] = 0;
  __syncthreads();
  const std::uint32_t pixel = blockIdx.x * blockDim.x + threadIdx.x;
  if (pixel < batch.pixel_count.divisor()) {
    // Only the scalar members are used: the lengths of all threads go to shared memory.
    PathTally mine;
    accumulate_pixel(film, batch, pixel, mine, [](int bin) { atomicAdd(&lengths[bin], 1u); });
    atomicAdd(reinterpret_cast<unsigned long long*>(&tally->rays), mine.rays);
    if (mine.shadow_rays > 0) {
      atomicAdd(reinterpret_cast<unsigned long long*>(&tally->shadow_rays), mine.shadow_rays);
    }
    if (mine.nonfinite > 0) {
      atomicAdd(reinterpret_cast<unsigned long long*>(&tally->nonfinite), mine.nonfinite);
    }
  }
  __syncthreads();
  for (int i = threadIdx.x; i < path_length_bins; i += blockDim.x) {
    if (lengths[i] > 0) {
      atomicAdd(reinterpret_cast<unsigned long long*>(&tally->lengths[i]), lengths[i]);
    }
  }
}

__global__ void start_clock(StageClock* clock) {
  std::uint64_t now;
  asm volatile("mov.u64 %0, %globaltimer;" : "=l"(now));
  clock->last_ns = now;
  clock->running = ClockId::idle;
}

__global__ void stop_clock(StageClock* clock) { stamp(clock, ClockId::idle); }

}  // namespace pt
