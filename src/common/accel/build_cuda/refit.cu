// Fits the boxes of finished trees to moved primitives: from the nodes that have leaves only, each
// thread climbs; at a node with several inner children the last thread to arrive continues.
#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/build/wide/encode_cwbvh.h"
#include "common/accel/build_cuda/kernels.cuh"
#include "common/accel/build_cuda/launch.cuh"

namespace pt::device_build {
namespace {

constexpr std::uint32_t no_parent = 0xffffffffu;

__device__ Bounds slot_bounds(const RefitJob& job, std::uint32_t first, std::uint32_t count) {
  Bounds box;
  for (std::uint32_t slot = first - job.first_slot; slot < first - job.first_slot + count; ++slot) {
    if (job.boxes != nullptr) {
      box.grow(job.boxes[job.order[slot]]);
    } else {
      const Triangle t = load_wide(&job.triangles[slot]);
      box.grow(hit_bounds(t.v0, t.v1, t.v2));
    }
  }
  return box;
}

__device__ Bounds inner_bounds(const RefitJob& job, std::uint32_t node) {
  return load_fresh(&job.bounds[node - job.first_node]).bounds();
}

// What differs between the formats: the inner children, and writing the node with its new boxes,
// which returns their union.
template <class Visit>
__device__ void for_each_inner(const Bvh2Node& node, Visit&& visit) {
  for (const std::uint32_t child : node.child) {
    if (!is_leaf(child)) visit(child);
  }
}
template <class Visit>
__device__ void for_each_inner(const CwbvhNode& node, Visit&& visit) {
  for (int i = 0; i < __popc(node.inner_mask()); ++i) visit(node.child_base + i);
}

__device__ Bounds refit_node(const RefitJob& job, Bvh2Node& node) {
  Bounds all;
  PT_UNROLL(2)
  for (int i = 0; i < 2; ++i) {
    const std::uint32_t child = node.child[i];
    if (i == 1 && child == node.child[0]) continue;  // unused: the tree is one primitive
    const Bounds box = is_leaf(child) ? slot_bounds(job, leaf_first(child), leaf_count(child))
                                      : inner_bounds(job, child);
    set_child_bounds(node, i, box);
    all.grow(box);
  }
  return all;
}

__device__ Bounds refit_node(const RefitJob& job, CwbvhNode& node) {
  CwbvhChildren children;
  CwbvhSlots slots;
  Bounds all;
  for (std::uint8_t& slot : slots.child) slot = no_cwbvh_child;
  for_each_cwbvh_child(node, [&](int s, const CwbvhChild& child) {
    const int c = children.count++;
    slots.child[s] = static_cast<std::uint8_t>(c);
    children.triangles[c] = child.count;
    children.bounds[c] = child.count == 0 ? inner_bounds(job, child.index)
                                          : slot_bounds(job, child.index, child.count);
    all.grow(children.bounds[c]);
  });
  node = encode_cwbvh_node(children, slots, node.child_base, node.triangle_base);
  return all;
}

template <class Node>
__global__ void __launch_bounds__(block_size) find_parents(RefitJob job, const Node* nodes) {
  const std::uint32_t k = blockIdx.x * blockDim.x + threadIdx.x;
  if (k >= job.node_count) return;
  if (k == 0) job.parents[0] = no_parent;
  std::uint32_t inner = 0;
  for_each_inner(load_wide(&nodes[k]), [&](std::uint32_t child) {
    job.parents[child - job.first_node] = k;
    ++inner;
  });
  job.waiting[k] = inner;
}

template <class Node>
__global__ void __launch_bounds__(block_size) refit_upwards(RefitJob job, Node* nodes) {
  std::uint32_t k = blockIdx.x * blockDim.x + threadIdx.x;
  if (k >= job.node_count) return;
  Node node = load_wide(&nodes[k]);
  bool has_inner = false;
  for_each_inner(node, [&](std::uint32_t) { has_inner = true; });
  if (has_inner) return;
  while (true) {
    const Bounds box = refit_node(job, node);
    store_wide(&nodes[k], node);
    store_wide(&job.bounds[k], BuildNode{box.min, 0, box.max, 0});
    const std::uint32_t parent = job.parents[k];
    if (parent == no_parent) return;
    __threadfence();  // before the count: whoever sees it sees the box
    if (atomicSub(&job.waiting[parent], 1u) > 1) return;
    __threadfence();
    k = parent;
    node = load_wide(&nodes[k]);
  }
}

template <class Node>
void refit(const RefitJob& job, Node* nodes) {
  find_parents<<<blocks_for(job.node_count), block_size>>>(job, nodes);
  refit_upwards<<<blocks_for(job.node_count), block_size>>>(job, nodes);
  check_cuda(cudaGetLastError(), "refit");
}

}  // namespace

void enqueue_refit(const RefitJob& job, Bvh2Node* nodes) { refit(job, nodes); }
void enqueue_refit(const RefitJob& job, CwbvhNode* nodes) { refit(job, nodes); }

}  // namespace pt::device_build
