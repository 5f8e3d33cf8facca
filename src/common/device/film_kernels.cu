#include "common/device/curand_state.cuh"
#include "common/device/film_kernels.cuh"
#include "common/device/stage_stamp.cuh"

namespace pt {

std::size_t random_state_bytes() { return sizeof(CurandState); }

/// The paper's render_init: one generator state per path.
__global__ void render_init(CurandState* states, SampleBuffer batch, std::uint64_t seed,
                            StageClock* clock) {
  stamp_first_thread(clock, StageId::render_init);
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= batch.path_count) return;
  const PathId id = batch.id_of(i);
  curand_init(xorwow_seed(seed, id), 0, 0, &states[i].state);
}

namespace {

__device__ void add_to(std::uint64_t* sum, std::uint64_t value) {
  atomicAdd(reinterpret_cast<unsigned long long*>(sum), static_cast<unsigned long long>(value));
}

// All counts are added up per block first: one address that every thread adds to would be the
// slowest part of the kernel by far. Called by all threads of a block, which has at most 1024.
template <class MakeSum>
__device__ void accumulate_block(const SampleBuffer& batch, PathTally* tally, MakeSum make_sum) {
  __shared__ std::uint64_t block_rays, block_shadow_rays, block_nonfinite;
  __shared__ std::uint32_t lengths[path_length_bins];
  for (int i = threadIdx.x; i < path_length_bins; i += blockDim.x) lengths[i] = 0;
  if (threadIdx.x == 0) block_rays = block_shadow_rays = block_nonfinite = 0;
  __syncthreads();
  const std::uint32_t pixel = blockIdx.x * blockDim.x + threadIdx.x;
  if (pixel < batch.pixel_count.divisor()) {
    PathTally mine;  // its lengths are not used: those of all threads go to shared memory
    accumulate_pixel(make_sum(pixel), batch, pixel, mine,
                     [](int bin) { atomicAdd(&lengths[bin], 1u); });
    add_to(&block_rays, mine.rays);
    if (mine.shadow_rays > 0) add_to(&block_shadow_rays, mine.shadow_rays);
    if (mine.nonfinite > 0) add_to(&block_nonfinite, mine.nonfinite);
  }
  __syncthreads();
  if (threadIdx.x == 0) {
    add_to(&tally->rays, block_rays);
    if (block_shadow_rays > 0) add_to(&tally->shadow_rays, block_shadow_rays);
    if (block_nonfinite > 0) add_to(&tally->nonfinite, block_nonfinite);
  }
  for (int i = threadIdx.x; i < path_length_bins; i += blockDim.x) {
    if (lengths[i] > 0) add_to(&tally->lengths[i], lengths[i]);
  }
}

}  // namespace

__global__ void __launch_bounds__(1024)
    accumulate_film(FilmPixel* film, SampleBuffer batch, PathTally* tally, StageClock* clock) {
  stamp_first_thread(clock, StageId::accumulate);
  accumulate_block(batch, tally, [&](std::uint32_t i) { return RadianceSum(film, i); });
}

__global__ void __launch_bounds__(1024)
    accumulate_planes(const __grid_constant__ FilmView film,
                      const __grid_constant__ SampleBuffer batch,
                      const __grid_constant__ PixelFilter filter, PhiloxSource source,
                      PathTally* tally, StageClock* clock) {
  stamp_first_thread(clock, StageId::accumulate);
  accumulate_block(batch, tally, [&](std::uint32_t i) {
    return PixelPlanes<PhiloxSource>(film, batch, filter, source, i);
  });
}

__global__ void start_clock(StageClock* clock) {
  std::uint64_t now;
  asm volatile("mov.u64 %0, %globaltimer;" : "=l"(now));
  clock->last_ns = now;
  clock->running = StageId::idle;
}

__global__ void stop_clock(StageClock* clock) { stamp(clock, StageId::idle); }

}  // namespace pt
