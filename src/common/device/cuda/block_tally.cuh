// Counts of paths, added up by a block of threads: one address that every thread of the device adds
// to would be the slowest part of a kernel by far.
#pragma once

#include "common/film/film.h"

namespace pt {

/// In shared memory. All threads of the block call begin() and end() together.
struct BlockTally {
  std::uint64_t rays, shadow_rays, nonfinite;
  std::uint32_t lengths[path_length_bins];

  __device__ void begin() {
    for (int i = threadIdx.x; i < path_length_bins; i += blockDim.x) lengths[i] = 0;
    if (threadIdx.x == 0) rays = shadow_rays = nonfinite = 0;
    __syncthreads();
  }

  __device__ void count(int bin) { atomicAdd(&lengths[bin], 1u); }

  /// All but the lengths.
  __device__ void add(const PathTally& mine) {
    atomic_add(&rays, mine.rays);
    if (mine.shadow_rays > 0) atomic_add(&shadow_rays, mine.shadow_rays);
    if (mine.nonfinite > 0) atomic_add(&nonfinite, mine.nonfinite);
  }

  __device__ void end(PathTally* tally) {
    __syncthreads();
    if (threadIdx.x == 0) {
      atomic_add(&tally->rays, rays);
      if (shadow_rays > 0) atomic_add(&tally->shadow_rays, shadow_rays);
      if (nonfinite > 0) atomic_add(&tally->nonfinite, nonfinite);
    }
    for (int i = threadIdx.x; i < path_length_bins; i += blockDim.x) {
      if (lengths[i] > 0) atomic_add(&tally->lengths[i], lengths[i]);
    }
  }
};

}  // namespace pt
