// Sums over the nodes of a finished tree: the device's share of measure_tree.
#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/build/wide/encode_cwbvh.h"
#include "common/accel/build_cuda/kernels.cuh"
#include "common/accel/build_cuda/launch.cuh"

namespace pt::device_build {
namespace {

// Calls visit(half area, triangles) for each child; an inner one has 0 triangles.
template <class Visit>
__device__ void for_each_child(const Bvh2Node& node, Visit&& visit) {
  const bool has_one = node.child[0] == node.child[1];
  for (int i = 0; i < (has_one ? 1 : 2); ++i) {
    const std::uint32_t child = node.child[i];
    visit(child_bounds(node, i).half_area(), is_leaf(child) ? leaf_count(child) : 0u);
  }
}
template <class Visit>
__device__ void for_each_child(const CwbvhNode& node, Visit&& visit) {
  for_each_cwbvh_child(node, [&](int slot, const CwbvhChild& child) {
    visit(decode_cwbvh_bounds(node, slot).half_area(), child.count);
  });
}

template <class T>
__device__ void add_from_warp(T value, T* sum) {
  for (int step = 16; step > 0; step /= 2) value += __shfl_down_sync(0xffffffffu, value, step);
  if (threadIdx.x % 32 == 0) atomicAdd(sum, value);
}

template <class Node>
__global__ void __launch_bounds__(block_size)
    sum_quality(const Node* nodes, std::uint32_t count, QualitySums* sums) {
  QualitySums mine{};
  const std::uint32_t step = gridDim.x * blockDim.x;
  for (std::uint32_t k = blockIdx.x * blockDim.x + threadIdx.x; k < count; k += step) {
    for_each_child(load_wide(&nodes[k]), [&](float half_area, std::uint32_t triangles) {
      if (triangles == 0) mine.node_area += static_cast<double>(half_area);
      mine.triangle_area += static_cast<double>(half_area) * triangles;
      mine.leaves += triangles > 0 ? 1 : 0;
      mine.slots += triangles;
    });
  }
  add_from_warp(mine.node_area, &sums->node_area);
  add_from_warp(mine.triangle_area, &sums->triangle_area);
  add_from_warp(mine.leaves, &sums->leaves);
  add_from_warp(mine.slots, &sums->slots);
}

template <class Node>
void enqueue(const Node* nodes, std::uint32_t count, QualitySums* sums) {
  check_cuda(cudaMemsetAsync(sums, 0, sizeof(QualitySums)), "clear sums");
  sum_quality<<<resident_blocks(sum_quality<Node>, count), block_size>>>(nodes, count, sums);
  check_cuda(cudaGetLastError(), "sum_quality");
}

}  // namespace

void enqueue_quality(const Bvh2Node* nodes, std::uint32_t count, QualitySums* sums) {
  enqueue(nodes, count, sums);
}
void enqueue_quality(const CwbvhNode* nodes, std::uint32_t count, QualitySums* sums) {
  enqueue(nodes, count, sums);
}

}  // namespace pt::device_build
