// The counting sort of the queue of surfaces on CUDA.
#include "common/device/cuda/bind_scene.cuh"
#include "common/device/cuda/counting_sort.cuh"
#include "common/device/cuda/stage_stamp.cuh"
#include "wavefront/wavefront_cuda.h"

namespace pt {
namespace {

constexpr int tile_block = 1024;
static_assert(kind_count <= tile_block);

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

}  // namespace

void WavefrontCuda::order_surfaces(const SurfaceOrder& order) {
  const std::uint32_t tiles = (buffers_.pool.slot_count + order_tile - 1) / order_tile;
  const std::uint32_t resident =
      resident_blocks(reinterpret_cast<const void*>(order_tiles), tile_block, 0);
  launch("order_tiles", order_tiles, std::min(tiles, resident), tile_block, 0, scene_, order,
         clock());
}

}  // namespace pt
