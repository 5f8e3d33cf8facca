// What a counting sort is made of where a block's threads have an element each.
#pragma once

#include "common/platform/platform.h"

namespace pt {

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

/// Adds the warp's threads of each kind to `next` and returns this one's index: what next[kind] was
/// before, and the peers before it. Called by whole warps.
__device__ inline std::uint32_t reserve_indices(std::uint32_t* next, int kind) {
  const Peers peers(kind);
  std::uint32_t first = 0;
  if (kind >= 0 && peers.before == 0) first = atomicAdd(&next[kind], peers.count);
  return __shfl_sync(0xffffffffu, first, __ffs(peers.mask) - 1) + peers.before;
}

/// How many come before the first of `kind`.
__device__ inline std::uint32_t sum_before(const std::uint32_t* counts, int kind) {
  std::uint32_t sum = 0;
  for (int k = 0; k < kind; ++k) sum += counts[k];
  return sum;
}

}  // namespace pt
