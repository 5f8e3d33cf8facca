// From the binary tree of single primitives to the trees for traversal, top-down, in one kernel
// (after Benthin et al. 2024, section on conversion): a queue of nodes that is the array of nodes,
// too. Thread k makes the nodes k, k + threads, ... as soon as each one's parent has put it into
// the queue; making a node puts its inner children there. All blocks must be resident.
#include "common/accel/build/wide/wide_children.h"
#include "common/accel/build_cuda/kernels.cuh"
#include "common/accel/build_cuda/launch.cuh"

namespace pt::device_build {
namespace {

constexpr unsigned all_lanes = 0xffffffffu;
constexpr std::uint64_t not_yet = ~std::uint64_t{0};
constexpr int collapse_block = 128;

__device__ std::uint64_t pack(std::uint32_t depth, TreeRef ref) {
  return static_cast<std::uint64_t>(depth) << 32 | ref;
}

template <class T>
__device__ T read_shared(const T* p) {
  return *static_cast<const volatile T*>(p);
}

// Places for a node's inner children and for its primitives.
struct Offsets {
  std::uint32_t node, slot;
};

// One atomic operation per warp. `nodes` <= 8 and `slots` <= 24 are what this lane needs.
__device__ Offsets allocate(CollapseCounters* counters, std::uint32_t nodes, std::uint32_t slots,
                            int lane) {
  const std::uint32_t mine = nodes << 16 | slots;
  std::uint32_t sum = mine;
  for (int step = 1; step < 32; step *= 2) {
    const std::uint32_t before = __shfl_up_sync(all_lanes, sum, step);
    if (lane >= step) sum += before;
  }
  unsigned long long base = 0;
  if (lane == 31) {
    base = atomicAdd(&counters->allocated,
                     static_cast<unsigned long long>(sum >> 16) << 32 | (sum & 0xffffu));
  }
  base = __shfl_sync(all_lanes, base, 31);
  const std::uint32_t before = sum - mine;
  return {static_cast<std::uint32_t>(base >> 32) + (before >> 16),
          static_cast<std::uint32_t>(base) + (before & 0xffffu)};
}

struct QueueWriter {
  const CollapseJob& job;
  Offsets offsets;
  std::uint32_t depth;  // of the children

  __device__ void push_node(TreeRef ref) {
    volatile std::uint64_t* queue = job.queue;
    queue[offsets.node++] = pack(depth, ref);
  }
  __device__ void push_primitives(TreeRef ref) {
    for_each_primitive(job.tree, ref, [&](std::uint32_t i) { job.order[offsets.slot++] = i; });
  }
};

// `Maker` chooses a node's children, counts them, and writes the node.
template <class Maker>
__device__ void drain_queue(const CollapseJob& job, const Maker& maker) {
  const int lane = threadIdx.x % 32;
  std::uint32_t depth_max = 0;
  std::uint32_t k = blockIdx.x * blockDim.x + threadIdx.x;
  while (true) {
    const std::uint64_t item = k < job.capacity ? read_shared(&job.queue[k]) : not_yet;
    const bool works = item != not_yet;
    if (!__any_sync(all_lanes, works)) {
      // All primitives have a slot: so all nodes have been taken by some thread.
      const auto allocated = static_cast<std::uint32_t>(read_shared(&job.counters->allocated));
      const bool ends = allocated == job.count || read_shared(&job.counters->overflowed) != 0;
      if (__any_sync(all_lanes, ends)) break;
      __nanosleep(100);
      continue;
    }
    typename Maker::Children children;
    std::uint32_t nodes = 0, slots = 0;
    if (works) {
      children = maker.choose(static_cast<TreeRef>(item));
      maker.count(children, nodes, slots);
    }
    const Offsets offsets = allocate(job.counters, nodes, slots, lane);
    if (!works) continue;
    const auto depth = static_cast<std::uint32_t>(item >> 32);
    if (offsets.node + nodes > job.capacity) {
      job.counters->overflowed = 1;
    } else {
      maker.write(k, children, QueueWriter{job, offsets, depth + 1});
    }
    depth_max = max(depth_max, depth);
    k += gridDim.x * blockDim.x;
  }
  depth_max = warp_max(depth_max);
  if (lane == 0 && depth_max > 0) atomicMax(&job.counters->depth, depth_max);
}

struct WideMaker {
  using Children = WideChildren;
  const CollapseJob& job;
  CwbvhNode* nodes;

  __device__ Children choose(TreeRef ref) const {
    return optimal_children(job.tree, job.costs, ref);
  }
  __device__ void count(const Children& c, std::uint32_t& inner, std::uint32_t& slots) const {
    inner = static_cast<std::uint32_t>(c.count - __popc(c.leaf_mask));
    PT_UNROLL(8)
    for (int i = 0; i < cwbvh_width; ++i) {
      slots += (c.leaf_mask >> i & 1u) != 0 ? ref_count(c.ref[i]) : 0u;
    }
  }
  __device__ void write(std::uint32_t k, const Children& c, QueueWriter queue) const {
    CwbvhChildren children;
    children.count = c.count;
    PT_UNROLL(8)
    for (int i = 0; i < cwbvh_width; ++i) {
      if (i >= c.count) continue;
      children.bounds[i] = load_node(job.tree, c.ref[i]).bounds();
      children.triangles[i] = (c.leaf_mask >> i & 1u) != 0 ? ref_count(c.ref[i]) : 0u;
    }
    const CwbvhSlots slots = assign_cwbvh_slots(children);
    store_wide(&nodes[k], encode_cwbvh_node(children, slots, job.first_node + queue.offsets.node,
                                            job.first_slot + queue.offsets.slot));
    for (const std::uint8_t child : slots.child) {
      if (child == no_cwbvh_child) continue;
      const TreeRef ref = detail::get_at(c.ref, child);
      if ((c.leaf_mask >> child & 1u) != 0) {
        queue.push_primitives(ref);
      } else {
        queue.push_node(ref);
      }
    }
  }
};

struct BinaryMaker {
  struct Children {
    TreeRef ref[2];
    Bounds box[2];
    bool is_leaf[2];
  };
  const CollapseJob& job;
  Bvh2Node* nodes;

  __device__ Children choose(TreeRef ref) const {
    const BuildNode node = load_node(job.tree, ref);
    if (is_primitive(ref)) {  // the whole tree
      return {{ref, ref}, {node.bounds(), unreachable_bounds()}, {true, true}};
    }
    Children c;
    c.ref[0] = node.left, c.ref[1] = node.right;
    PT_UNROLL(2)
    for (int i = 0; i < 2; ++i) {
      c.box[i] = load_node(job.tree, c.ref[i]).bounds();
      c.is_leaf[i] = is_binary_leaf(job.tree, job.costs, c.ref[i], c.box[i].half_area());
    }
    return c;
  }
  __device__ void count(const Children& c, std::uint32_t& inner, std::uint32_t& slots) const {
    PT_UNROLL(2)
    for (int i = 0; i < 2; ++i) {
      inner += c.is_leaf[i] ? 0u : 1u;
      slots += c.is_leaf[i] ? ref_count(c.ref[i]) : 0u;
    }
    if (c.ref[0] == c.ref[1]) slots = 1;
  }
  __device__ void write(std::uint32_t k, const Children& c, QueueWriter queue) const {
    Bvh2Node node;
    node.padding[0] = node.padding[1] = 0;
    PT_UNROLL(2)
    for (int i = 0; i < 2; ++i) {
      set_child_bounds(node, i, c.box[i]);
      if (i == 1 && c.ref[0] == c.ref[1]) {
        node.child[1] = node.child[0];
      } else if (c.is_leaf[i]) {
        node.child[i] = make_leaf(job.first_slot + queue.offsets.slot, ref_count(c.ref[i]));
        queue.push_primitives(c.ref[i]);
      } else {
        node.child[i] = job.first_node + queue.offsets.node;
        queue.push_node(c.ref[i]);
      }
    }
    store_wide(&nodes[k], node);
  }
};

__global__ void __launch_bounds__(collapse_block)
    collapse_wide(const __grid_constant__ CollapseJob job, CwbvhNode* nodes) {
  drain_queue(job, WideMaker{job, nodes});
}

__global__ void __launch_bounds__(collapse_block)
    collapse_binary(const __grid_constant__ CollapseJob job, Bvh2Node* nodes) {
  drain_queue(job, BinaryMaker{job, nodes});
}

__global__ void seed_queue(CollapseJob job) {
  job.queue[0] = pack(1, *job.root);
  job.counters->allocated = 1ull << 32;  // the root
}

template <class Kernel, class Node>
void launch(Kernel kernel, const CollapseJob& job, Node* nodes) {
  check_cuda(cudaMemsetAsync(job.queue, 0xff, job.capacity * sizeof(std::uint64_t)), "clear queue");
  check_cuda(cudaMemsetAsync(job.counters, 0, sizeof(CollapseCounters)), "clear counters");
  seed_queue<<<1, 1>>>(job);
  kernel<<<resident_blocks(kernel, job.capacity, collapse_block), collapse_block>>>(job, nodes);
  check_cuda(cudaGetLastError(), "collapse");
}

}  // namespace

void enqueue_collapse(const CollapseJob& job, Bvh2Node* nodes) {
  launch(collapse_binary, job, nodes);
}

void enqueue_collapse(const CollapseJob& job, CwbvhNode* nodes) {
  launch(collapse_wide, job, nodes);
}

}  // namespace pt::device_build
