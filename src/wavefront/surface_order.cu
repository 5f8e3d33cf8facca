// The counting sort of the surfaces on CUDA: one kernel counts, one puts them in their places.
#include "common/device/bind_scene.cuh"
#include "common/device/stage_stamp.cuh"
#include "wavefront/wavefront_cuda.h"

namespace pt {
namespace {

#ifndef PT_ORDER_BLOCK
#define PT_ORDER_BLOCK 256
#endif
constexpr int order_block = PT_ORDER_BLOCK;
static_assert(kind_count <= order_block);

/// How many of a warp's threads have this thread's `kind`, and how many of them come before it.
/// Called by whole warps; `kind` is below 0 for those that have none.
struct Peers {
  unsigned mask;
  std::uint32_t count, before;

  __device__ explicit Peers(int kind) : mask(__match_any_sync(0xffffffffu, kind)) {
    const unsigned lane = threadIdx.x & 31;
    count = __popc(mask);
    before = __popc(mask & ((1u << lane) - 1));
  }
};

/// Adds a block's threads of each kind to `total` and returns the place that this one gets: behind
/// those that came before the block. Called by all threads of the block.
__device__ std::uint32_t add_kinds(std::uint32_t (&shared)[kind_count], std::uint32_t* total,
                                   int kind) {
  if (threadIdx.x < kind_count) shared[threadIdx.x] = 0;
  __syncthreads();
  const Peers peers(kind);
  std::uint32_t place = 0;
  if (kind >= 0 && peers.before == 0) place = atomicAdd(&shared[kind], peers.count);
  place = __shfl_sync(0xffffffffu, place, __ffs(peers.mask) - 1) + peers.before;
  __syncthreads();
  if (threadIdx.x < kind_count && shared[threadIdx.x] > 0) {
    shared[threadIdx.x] = atomicAdd(&total[threadIdx.x], shared[threadIdx.x]);
  }
  __syncthreads();
  if (kind >= 0) place += shared[kind];
  __syncthreads();
  return place;
}

__global__ void __launch_bounds__(order_block)
    count_surfaces(const __grid_constant__ Scene scene, const __grid_constant__ SurfaceOrder order,
                   StageClock* clock) {
  __shared__ std::uint32_t shared[kind_count];
  stamp_first_thread(clock, StageId::order_surfaces);
  const std::uint32_t count = *order.count;
  for (std::uint32_t base = blockIdx.x * blockDim.x; base < count; base += gridDim.x * blockDim.x) {
    const std::uint32_t i = base + threadIdx.x;
    int kind = -1;
    if (i < count) {
      kind = surface_kind(scene, order.pool, order.slots[i]);
      order.kinds[i] = static_cast<std::uint8_t>(kind);
    }
    add_kinds(shared, order.ranges->count, kind);
  }
}

__global__ void __launch_bounds__(order_block)
    place_surfaces(const __grid_constant__ SurfaceOrder order, StageClock* clock) {
  __shared__ std::uint32_t shared[kind_count], first[kind_count];
  stamp_first_thread(clock, StageId::order_surfaces);
  const std::uint32_t count = *order.count;
  if (blockIdx.x * blockDim.x >= count && blockIdx.x > 0) return;
  if (threadIdx.x < kind_count) {
    std::uint32_t sum = 0;
    for (int k = 0; k < static_cast<int>(threadIdx.x); ++k) sum += order.ranges->count[k];
    first[threadIdx.x] = sum;
    if (blockIdx.x == 0) order.ranges->first[threadIdx.x] = sum;
  }
  for (std::uint32_t base = blockIdx.x * blockDim.x; base < count; base += gridDim.x * blockDim.x) {
    const std::uint32_t i = base + threadIdx.x;
    const int kind = i < count ? order.kinds[i] : -1;
    const std::uint32_t place = add_kinds(shared, order.ranges->placed, kind);
    if (kind >= 0) order.ordered[first[kind] + place] = order.slots[i];
  }
}

}  // namespace

void WavefrontCuda::order_surfaces(const SurfaceOrder& order) {
  const auto blocks_of = [&](const void* kernel) {
    const std::uint32_t wanted = (buffers_.pool.slot_count + order_block - 1) / order_block;
    return std::min(wanted, resident_blocks(kernel, order_block, 0));
  };
  launch("count_surfaces", count_surfaces, blocks_of(reinterpret_cast<const void*>(count_surfaces)),
         order_block, 0, scene_, order, clock());
  launch("place_surfaces", place_surfaces, blocks_of(reinterpret_cast<const void*>(place_surfaces)),
         order_block, 0, order, clock());
}

}  // namespace pt
