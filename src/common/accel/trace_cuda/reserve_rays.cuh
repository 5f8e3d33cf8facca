// How persistent warps share out the rays of an array or a queue.
#pragma once

#include "common/accel/ray_arrays.h"

namespace pt {

/// All threads of the warp call it together, and get up to 32 rays with successive numbers, one
/// each for the first `count` lanes; the first one's number is returned. `next` counts the rays
/// handed out, of `all`. Warps reserve `batch` at once, a multiple of 32: few atomic operations.
template <std::uint32_t batch>
__device__ std::uint32_t reserve_rays(std::uint32_t* next, const std::uint32_t& all, unsigned lane,
                                      ReservedRays& reserved, int& count) {
  static_assert(batch % 32 == 0);
  std::uint32_t first = reserved.next;
  if (first == reserved.end) {
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
