// How persistent warps share out the rays of an array or a queue.
#pragma once

#include "common/accel/ray_arrays.h"

namespace pt {

/// How many rays a warp reserves at once, of `left` that are shared by `threads` threads: an eighth
/// of what comes to a warp, a multiple of 32 up to 512. While many are left, few atomic operations:
/// one for every 32 rays costs long queues 1 to 2 % (results/). In the end, few rays: others would
/// have none while those of a slow warp wait in its reserve.
PT_HD std::uint32_t reserved_batch(std::uint32_t left, std::uint32_t threads) {
  constexpr std::uint32_t least = 32, most = 512;
  const std::uint32_t share = left / (threads / 4) & ~31u;
  return share < least ? least : share > most ? most : share;
}

/// All threads of the warp call it together, and get up to 32 rays with successive indices, one
/// each for the first `count` lanes; the first one's index is returned. `next` counts the rays
/// handed out, of `all`. By reserved.end the warp knows how many were left at its last reservation.
__device__ inline std::uint32_t reserve_rays(std::uint32_t* next, const std::uint32_t& all,
                                             unsigned lane, ReservedRays& reserved, int& count) {
  std::uint32_t first = reserved.next;
  if (first == reserved.end) {
    const std::uint32_t left = reserved.end < all ? all - reserved.end : 0;
    const std::uint32_t batch = reserved_batch(left, gridDim.x * blockDim.x);
    if (lane == 0) first = atomicAdd(next, batch);
    first = __shfl_sync(0xffffffffu, first, 0);
    reserved.end = first + batch;
  }
  __syncwarp();
  reserved.next = first + 32;
  const std::uint32_t total = all;  // in memory: read when it is needed, not before
  count = first < total ? static_cast<int>(min(32u, total - first)) : 0;
  return first;
}

}  // namespace pt
