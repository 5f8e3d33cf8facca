// Launches and memory accesses that the device builders' kernels share.
#pragma once

#include <algorithm>

#include "common/accel/build/binary/build_tree.h"
#include "common/cuda/cuda_check.cuh"

namespace pt::device_build {

inline constexpr int block_size = 256;

/// Blocks for one thread per element.
inline unsigned blocks_for(std::uint64_t count) {
  return static_cast<unsigned>((count + block_size - 1) / block_size);
}

/// As many blocks as are resident at once, for kernels that loop, but no more than needed.
template <class Kernel>
unsigned resident_blocks(Kernel kernel, std::uint64_t count, int block = block_size) {
  int device = 0, processors = 0, per_processor = 0;
  check_cuda(cudaGetDevice(&device), "cudaGetDevice");
  check_cuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device),
             "cudaDeviceGetAttribute");
  check_cuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&per_processor, kernel, block, 0),
             "occupancy");
  const auto resident = static_cast<unsigned>(std::max(1, processors * per_processor));
  return std::clamp(static_cast<unsigned>((count + block - 1) / block), 1u, resident);
}

/// *p as other multiprocessors have written it in this kernel: past the first-level cache.
template <class T>
__device__ T load_fresh(const T* p) {
  static_assert(sizeof(T) % 16 == 0 && alignof(T) % 16 == 0);
  T value;
  PT_UNROLL(4)
  for (int i = 0; i < static_cast<int>(sizeof(T) / 16); ++i) {
    const uint4 part = __ldcg(reinterpret_cast<const uint4*>(p) + i);
    memcpy(reinterpret_cast<char*>(&value) + 16 * i, &part, 16);
  }
  return value;
}

/// A subtree's node while the hierarchy is being made.
__device__ inline BuildNode load_fresh(const BuildNode* primitives, const BuildNode* nodes,
                                       TreeRef ref) {
  return load_fresh((is_primitive(ref) ? primitives : nodes) + ref_index(ref));
}

}  // namespace pt::device_build
