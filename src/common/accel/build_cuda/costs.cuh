// What the hierarchy builders find out about each subtree for the later collapse: one of these
// policies is a kernel's template argument.
#pragma once

#include "common/accel/build/wide/collapse_cost.h"
#include "common/accel/build_cuda/kernels.cuh"
#include "common/accel/build_cuda/launch.cuh"

namespace pt::device_build {

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
