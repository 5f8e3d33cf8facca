// Sums over the nodes of a finished tree.
#include "common/accel/build_kernels.cuh"
#include "common/accel/build_launch.cuh"
#include "common/accel/tree_cost.h"

namespace pt::device_build {
namespace {

template <class T>
__device__ void add_from_warp(T value, T* sum) {
  for (int step = 16; step > 0; step /= 2) value += __shfl_down_sync(0xffffffffu, value, step);
  if (threadIdx.x % 32 == 0) atomicAdd(sum, value);
}

template <class Node>
__global__ void __launch_bounds__(block_size)
    sum_costs(const Node* nodes, std::uint32_t count, CollapseCosts costs, StatisticsSums* sums) {
  double area_cost = 0;
  unsigned long long inner = 0, leaves = 0, primitives = 0;
  const std::uint32_t step = gridDim.x * blockDim.x;
  for (std::uint32_t k = blockIdx.x * blockDim.x + threadIdx.x; k < count; k += step) {
    const NodeCost cost = node_cost(load_wide(&nodes[k]), costs);
    area_cost += cost.area_cost;
    inner += cost.inner_children;
    leaves += cost.leaves;
    primitives += cost.leaf_primitives;
  }
  add_from_warp(area_cost, &sums->area_cost);
  add_from_warp(inner, &sums->inner_children);
  add_from_warp(leaves, &sums->leaves);
  add_from_warp(primitives, &sums->leaf_primitives);
}

template <class Node>
void sum(const Node* nodes, std::uint32_t count, const CollapseCosts& costs, StatisticsSums* sums) {
  check_cuda(cudaMemsetAsync(sums, 0, sizeof(StatisticsSums)), "clear sums");
  sum_costs<<<resident_blocks(sum_costs<Node>, count), block_size>>>(nodes, count, costs, sums);
  check_cuda(cudaGetLastError(), "statistics");
}

}  // namespace

void enqueue_statistics(const Bvh2Node* nodes, std::uint32_t count, const CollapseCosts& costs,
                        StatisticsSums* sums) {
  sum(nodes, count, costs, sums);
}
void enqueue_statistics(const CwbvhNode* nodes, std::uint32_t count, const CollapseCosts& costs,
                        StatisticsSums* sums) {
  sum(nodes, count, costs, sums);
}

}  // namespace pt::device_build
