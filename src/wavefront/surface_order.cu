// The counting sort of the surfaces on CUDA: one kernel for tiles; for ranges one that counts and
// one that scatters them.
#include "common/device/cuda/bind_scene.cuh"
#include "common/device/cuda/counting_sort.cuh"
#include "common/device/cuda/stage_stamp.cuh"
#include "wavefront/wavefront_cuda.h"

namespace pt {
namespace {

constexpr int order_block = 256;
static_assert(kind_count <= order_block);

constexpr int tile_block = 1024;

/// A block puts a tile in order.
__global__ void __launch_bounds__(tile_block, 2)
    order_tiles(const __grid_constant__ Scene scene, const __grid_constant__ SurfaceOrder order,
                StageClock* clock) {
  __shared__ std::uint32_t counts[kind_count], next[kind_count];
  __shared__ std::int8_t kinds[order_tile];  // of its entries, below 0 behind the queue's end
  stamp_first_thread(clock, StageId::order_surfaces);
  const std::uint32_t count = *order.count;
  for (std::uint32_t tile = blockIdx.x * order_tile; tile < count; tile += gridDim.x * order_tile) {
    __syncthreads();  // slower warps may still put the last tile in order
    if (threadIdx.x < kind_count) counts[threadIdx.x] = 0;
    __syncthreads();
    const std::uint32_t in_tile = min(count - tile, order_tile);
    const std::uint32_t end = (in_tile + 31) / 32 * 32;  // by whole warps
    for (std::uint32_t i = threadIdx.x; i < end; i += tile_block) {
      int kind = -1;
      if (i < in_tile) kind = surface_kind(scene, order.pool, order.slots[tile + i]);
      kinds[i] = static_cast<std::int8_t>(kind);
      reserve_indices(counts, kind);
    }
    __syncthreads();
    if (threadIdx.x < kind_count) next[threadIdx.x] = tile + sum_before(counts, threadIdx.x);
    __syncthreads();
    for (std::uint32_t i = threadIdx.x; i < end; i += tile_block) {
      const std::uint32_t index = reserve_indices(next, kinds[i]);
      if (i < in_tile) order.ordered[index] = order.slots[tile + i];
    }
  }
}

/// Adds up the kinds of the whole queue.
__global__ void __launch_bounds__(order_block)
    count_surfaces(const __grid_constant__ Scene scene, const __grid_constant__ SurfaceOrder order,
                   StageClock* clock) {
  __shared__ std::uint32_t counts[kind_count];
  stamp_first_thread(clock, StageId::order_surfaces);
  const std::uint32_t count = *order.count;
  if (threadIdx.x < kind_count) counts[threadIdx.x] = 0;
  __syncthreads();
  for (std::uint32_t base = blockIdx.x * blockDim.x; base < count; base += gridDim.x * blockDim.x) {
    const std::uint32_t i = base + threadIdx.x;
    int kind = -1;
    if (i < count) {
      kind = surface_kind(scene, order.pool, order.slots[i]);
      order.kinds[i] = static_cast<std::uint8_t>(kind);
    }
    reserve_indices(counts, kind);
  }
  __syncthreads();
  if (threadIdx.x < kind_count && counts[threadIdx.x] > 0) {
    atomicAdd(&order.ranges->count[threadIdx.x], counts[threadIdx.x]);
  }
}

__global__ void __launch_bounds__(order_block)
    place_surfaces(const __grid_constant__ SurfaceOrder order, StageClock* clock) {
  __shared__ std::uint32_t counts[kind_count], next[kind_count], first[kind_count];
  stamp_first_thread(clock, StageId::order_surfaces);
  const std::uint32_t count = *order.count;
  if (blockIdx.x * blockDim.x >= count && blockIdx.x > 0) return;
  if (threadIdx.x < kind_count) {
    first[threadIdx.x] = sum_before(order.ranges->count, threadIdx.x);
    if (blockIdx.x == 0) order.ranges->first[threadIdx.x] = first[threadIdx.x];
  }
  for (std::uint32_t base = blockIdx.x * blockDim.x; base < count; base += gridDim.x * blockDim.x) {
    const std::uint32_t i = base + threadIdx.x;
    const int kind = i < count ? order.kinds[i] : -1;
    if (threadIdx.x < kind_count) counts[threadIdx.x] = 0;
    __syncthreads();
    const std::uint32_t index = reserve_indices(counts, kind);
    __syncthreads();
    if (threadIdx.x < kind_count && counts[threadIdx.x] > 0) {
      next[threadIdx.x] =
          first[threadIdx.x] + atomicAdd(&order.ranges->placed[threadIdx.x], counts[threadIdx.x]);
    }
    __syncthreads();
    if (kind >= 0) order.ordered[next[kind] + index] = order.slots[i];
  }
}

}  // namespace

void WavefrontCuda::order_surfaces(const SurfaceOrder& order) {
  const auto run = [&](const char* name, auto* kernel, int block, std::uint32_t per_block,
                       const auto&... arguments) {
    const std::uint32_t wanted = (buffers_.pool.slot_count + per_block - 1) / per_block;
    const std::uint32_t resident = resident_blocks(reinterpret_cast<const void*>(kernel), block, 0);
    launch(name, kernel, std::min(wanted, resident), block, 0, arguments..., order, clock());
  };
  if (order.ranges == nullptr)
    return run("order_tiles", order_tiles, tile_block, order_tile, scene_);
  run("count_surfaces", count_surfaces, order_block, order_block, scene_);
  run("place_surfaces", place_surfaces, order_block, order_block);
}

}  // namespace pt
