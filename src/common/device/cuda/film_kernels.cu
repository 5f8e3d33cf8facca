#include "common/device/cuda/block_tally.cuh"
#include "common/device/cuda/curand_state.cuh"
#include "common/device/cuda/film_kernels.cuh"
#include "common/device/cuda/stage_stamp.cuh"

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

// Called by all threads of a block, which has at most 1024.
template <class MakeSum>
__device__ void accumulate_block(const SampleBuffer& batch, PathTally* tally, MakeSum make_sum) {
  __shared__ BlockTally block;
  block.begin();
  const std::uint32_t pixel = blockIdx.x * blockDim.x + threadIdx.x;
  if (pixel < batch.pixel_count.divisor()) {
    PathTally mine;  // its lengths are not used: those of all threads go to shared memory
    accumulate_pixel(make_sum(pixel), batch, pixel, mine, [](int bin) { block.count(bin); });
    block.add(mine);
  }
  block.end(tally);
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
                      const __grid_constant__ PixelFilter filter, SamplerSource source,
                      PathTally* tally, StageClock* clock) {
  stamp_first_thread(clock, StageId::accumulate);
  accumulate_block(batch, tally, [&](std::uint32_t i) {
    return PixelPlanes<SamplerSource>(film, batch, filter, source, i);
  });
}

namespace {

__global__ void develop_pixels(const FilmPixel* film, float* rgb, std::uint32_t pixel_count) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= pixel_count) return;
  const double to_mean = film[i].to_mean();
  for (int c = 0; c < 3; ++c)
    rgb[3 * std::size_t{i} + c] = static_cast<float>(film[i].sum[c] * to_mean);
}

}  // namespace

void develop_film(const FilmPixel* film, float* rgb, std::uint32_t pixel_count,
                  cudaStream_t stream) {
  constexpr std::uint32_t block = 256;
  develop_pixels<<<(pixel_count + block - 1) / block, block, 0, stream>>>(film, rgb, pixel_count);
}

__global__ void start_clock(StageClock* clock) {
  std::uint64_t now;
  asm volatile("mov.u64 %0, %globaltimer;" : "=l"(now));
  clock->last_ns = now;
  clock->running = StageId::idle;
}

__global__ void stamp_stage(StageClock* clock, StageId id) { stamp(clock, id); }

}  // namespace pt
