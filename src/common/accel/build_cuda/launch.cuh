// What the device builders' kernels share: launches, memory accesses, and the costs of subtrees.
#pragma once

#include <algorithm>

#include "common/accel/build/binary/build_tree.h"
#include "common/accel/build/wide/wide_children.h"
#include "common/accel/build_cuda/kernels.cuh"
#include "common/cuda/cuda_check.cuh"
#include "common/cuda/used_gpu.cuh"

namespace pt::device_build {

inline constexpr int block_size = 256;

/// Blocks for one thread per element.
inline unsigned blocks_for(std::uint64_t count) {
  return static_cast<unsigned>((count + block_size - 1) / block_size);
}

/// As many blocks as are resident at once, for kernels that loop, but no more than needed.
template <class Kernel>
unsigned resident_blocks(Kernel kernel, std::uint64_t count, int block = block_size) {
  int per_processor = 0;
  check_cuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&per_processor, kernel, block, 0),
             "occupancy");
  const auto resident = static_cast<unsigned>(std::max(1, used_multiprocessors() * per_processor));
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

// What the hierarchy builders compute for each subtree for the later collapse. One of these
// policies is a kernel's template argument.

struct NoCosts {
  struct Value {};
  __device__ static Value of_primitive(const HierarchyJob&, float) { return {}; }
  __device__ static Value load(const HierarchyJob&, std::uint32_t) { return {}; }
  __device__ static Value join(const HierarchyJob&, std::uint32_t, const Value&, const Value&,
                               float, std::uint32_t) {
    return {};
  }
};

/// For leaves of binary trees.
struct BinaryCosts {
  using Value = float;
  __device__ static Value of_primitive(const HierarchyJob& job, float area) {
    return binary_leaf_cost(job.costs, area, 1);
  }
  __device__ static Value load(const HierarchyJob& job, std::uint32_t node) {
    return __ldcg(&job.binary_costs[node]);
  }
  /// Also stores the value, at `node`.
  __device__ static Value join(const HierarchyJob& job, std::uint32_t node, Value left, Value right,
                               float area, std::uint32_t count) {
    return job.binary_costs[node] = binary_cost(job.costs, left, right, area, count);
  }
};

/// For the optimal collapse to wide nodes.
struct WideCosts {
  using Value = CollapseTable;
  __device__ static Value of_primitive(const HierarchyJob& job, float area) {
    return primitive_table(job.costs, area);
  }
  __device__ static Value load(const HierarchyJob& job, std::uint32_t node) {
    return load_fresh(&job.tables[node]);
  }
  __device__ static Value join(const HierarchyJob& job, std::uint32_t node, const Value& left,
                               const Value& right, float area, std::uint32_t count) {
    const Value value = join_tables(job.costs, left, right, area, count);
    store_wide(&job.tables[node], value);
    return value;
  }
};

template <class Costs>
__device__ typename Costs::Value costs_of(const HierarchyJob& job, TreeRef ref, const Bounds& box) {
  return is_primitive(ref) ? Costs::of_primitive(job, box.half_area())
                           : Costs::load(job, ref_index(ref));
}

/// Calls launch(policy).
template <class Launch>
void with_costs(const HierarchyJob& job, Launch&& launch) {
  if (job.tables != nullptr) {
    launch(WideCosts());
  } else if (job.binary_costs != nullptr) {
    launch(BinaryCosts());
  } else {
    launch(NoCosts());
  }
}

}  // namespace pt::device_build
