// The builders of binary trees: the linear BVH and H-PLOC.
#include "common/accel/build/morton_order.h"
#include "common/accel/build_cuda/launch.cuh"

namespace pt::device_build {
namespace {

// The linear BVH: the radix tree of the Morton codes, built bottom-up in one pass (Apetrei 2014,
// 'Fast and Simple Agglomerative LBVH Construction').

constexpr unsigned long long no_subtree = ~0ull;

// What the first child to reach a node leaves there for the second: its subtree, and how far the
// subtree reaches on the side away from the node's split.
__device__ unsigned long long pack(TreeRef ref, std::uint32_t end) {
  return static_cast<unsigned long long>(ref) << 32 | end;
}

// A node is found at the position of its split, between `split` and `split` + 1. Each thread climbs
// from its leaf; of two that meet at a node the first one ends.
template <class Costs>
__global__ void __launch_bounds__(block_size) climb(HierarchyJob job) {
  const std::uint32_t leaf = blockIdx.x * blockDim.x + threadIdx.x;
  if (leaf >= job.count) return;
  std::uint32_t first = leaf, last = leaf;
  TreeRef ref = make_ref(1, job.order[leaf]);
  Bounds box = load_wide(&job.primitives[ref_index(ref)]).bounds();
  typename Costs::Value costs = Costs::of_primitive(job, box.half_area());
  while (first > 0 || last + 1 < job.count) {
    const bool is_left = job.prefixes[last + 1] > job.prefixes[first];
    const std::uint32_t split = is_left ? last : first - 1;
    __threadfence();  // before the exchange: whoever sees it sees the subtree
    const unsigned long long other =
        atomicExch(reinterpret_cast<unsigned long long*>(&job.pairs[split]),
                   pack(ref, is_left ? first : last));
    if (other == no_subtree) return;
    __threadfence();
    const auto other_ref = static_cast<TreeRef>(other >> 32);
    const Bounds other_box = load_fresh(job.primitives, job.nodes, other_ref).bounds();
    const typename Costs::Value other_costs = costs_of<Costs>(job, other_ref, other_box);
    (is_left ? last : first) = static_cast<std::uint32_t>(other);
    box.grow(other_box);
    const std::uint32_t count = ref_count(ref) + ref_count(other_ref);
    const TreeRef left = is_left ? ref : other_ref, right = is_left ? other_ref : ref;
    store_wide(&job.nodes[split], BuildNode{box.min, left, box.max, right});
    // In the nodes' order, so that the collapse finds the same sums.
    costs = Costs::join(job, split, is_left ? costs : other_costs, is_left ? other_costs : costs,
                        box.half_area(), count);
    ref = make_ref(count, split);
  }
  *job.root = ref;
}

}  // namespace

void enqueue_lbvh(const HierarchyJob& job) {
  check_cuda(cudaMemsetAsync(job.pairs, 0xff, job.count * sizeof(std::uint64_t)), "clear pairs");
  with_costs(
      job, [&](auto costs) { climb<decltype(costs)><<<blocks_for(job.count), block_size>>>(job); });
  check_cuda(cudaGetLastError(), "lbvh");
}

// H-PLOC: locally-ordered clustering along the radix tree of the Morton codes, in one kernel
// (Benthin, Meister, Barczak, Mehalwal, Tsakok and Kensler 2024, 'H-PLOC: Hierarchical Parallel
// Locally-Ordered Clustering for Bounding Volume Hierarchy Construction').
//
// Each lane climbs the radix tree from its leaf, as in the linear BVH, but only to learn which
// range of leaves a node covers. When a range exceeds `merge_above` leaves, the whole warp takes
// the clusters that are left of both halves and merges neighbours until `kept` of them remain,
// which it leaves for the node above.
//
// Unlike the paper's, nodes are not allocated by a counter: each cluster owns a free element of the
// node array, at first its leaf's. A merged node takes the lower member's, and the cluster keeps
// the other one's. So the tree lies in memory in the same way whatever the order of the threads,
// close to the leaves' order, and without an atomic operation.

namespace {

constexpr int kept = 16;  // of a half; two halves fill a warp
constexpr std::uint32_t merge_above = kept;
constexpr unsigned all_lanes = 0xffffffffu;
constexpr std::uint32_t nobody = 0xffffffffu;
constexpr int hploc_block = 128;

struct Cluster {
  TreeRef ref;  // nobody: none
  std::uint32_t node_index;
};

__device__ std::uint64_t pack(const Cluster& c) {
  return static_cast<std::uint64_t>(c.node_index) << 32 | c.ref;
}
__device__ Cluster unpack(std::uint64_t bits) {
  return {static_cast<TreeRef>(bits), static_cast<std::uint32_t>(bits >> 32)};
}

// The clusters of a range in shared memory, one per lane: reading a neighbour's box there takes a
// third of the instructions that shuffling it would. Places from `count` on hold anything.
struct WarpClusters {
  float4 low[32 + ploc_radius];   // min, and max.x
  float2 high[32 + ploc_radius];  // max.y, max.z
  Cluster cluster[32];

  __device__ Bounds box(int i) const {
    return {{low[i].x, low[i].y, low[i].z}, {low[i].w, high[i].x, high[i].y}};
  }
  __device__ void set(int i, const Cluster& c, const Bounds& b) {
    low[i] = {b.min.x, b.min.y, b.min.z, b.max.x};
    high[i] = {b.max.y, b.max.z};
    cluster[i] = c;
  }
};

__device__ int find_partner(const WarpClusters& clusters, const Bounds& box, int count, int lane) {
  std::uint32_t best = no_pair;
  PT_UNROLL(8)
  for (int distance = 1; distance <= ploc_radius; ++distance) {
    std::uint32_t rank = pair_rank(box, clusters.box(lane + distance), lane, distance);
    if (lane + distance >= count) rank = no_pair;
    const std::uint32_t below = __shfl_up_sync(all_lanes, rank, distance);
    best = min(best, lane >= distance ? min(rank, below) : rank);
  }
  return best == no_pair ? lane : pair_partner(best, lane);
}

// Joins the pairs that chose each other, and closes the gaps. Never none: the pair of the least
// rank has chosen each other. Returns how many clusters are left.
template <class Costs>
__device__ int merge_pairs(const HierarchyJob& job, WarpClusters& clusters, int count, int lane) {
  Cluster mine = clusters.cluster[lane];
  Bounds box = clusters.box(lane);
  const int partner = find_partner(clusters, box, count, lane);
  const int its_partner = __shfl_sync(all_lanes, partner, partner & 31);
  const bool pairs = partner != lane && its_partner == lane && lane < count;
  if (pairs && lane < partner) {
    const Cluster other = clusters.cluster[partner];
    const Bounds other_box = clusters.box(partner);
    const std::uint32_t size = ref_count(mine.ref) + ref_count(other.ref);
    const auto costs = costs_of<Costs>(job, mine.ref, box);
    const auto other_costs = costs_of<Costs>(job, other.ref, other_box);
    box.grow(other_box);
    store_wide(&job.nodes[mine.node_index], BuildNode{box.min, mine.ref, box.max, other.ref});
    Costs::join(job, mine.node_index, costs, other_costs, box.half_area(), size);
    mine = {make_ref(size, mine.node_index), other.node_index};
  }
  const bool stays = lane < count && !(pairs && lane > partner);
  const unsigned staying = __ballot_sync(all_lanes, stays);
  __syncwarp();  // all have read: boxes may move
  if (stays) clusters.set(__popc(staying & ((1u << lane) - 1u)), mine, box);
  __syncwarp();  // also makes the nodes and costs known to the other lanes
  return __popc(staying);
}

// The clusters of leaves [first, split) and [split, last], closed up.
__device__ int load_clusters(const HierarchyJob& job, std::uint32_t first, std::uint32_t split,
                             std::uint32_t last, WarpClusters& clusters, int lane) {
  const bool is_left = lane < kept;
  const std::uint32_t index = is_left ? first + lane : split + (lane - kept);
  const bool is_inside = index < (is_left ? split : last + 1);
  const Cluster mine = is_inside ? unpack(__ldcg(&job.pairs[index])) : Cluster{nobody, 0};
  const bool is_found = mine.ref != nobody;
  const unsigned found = __ballot_sync(all_lanes, is_found);
  if (is_found) {
    clusters.set(__popc(found & ((1u << lane) - 1u)), mine,
                 load_fresh(job.primitives, job.nodes, mine.ref).bounds());
  }
  __syncwarp();
  return __popc(found);
}

template <class Costs>
__device__ void merge_range(const HierarchyJob& job, std::uint32_t first, std::uint32_t split,
                            std::uint32_t last, WarpClusters& clusters, int lane) {
  const bool is_whole = last - first + 1 == job.count;
  int count = load_clusters(job, first, split, last, clusters, lane);
  while (count > (is_whole ? 1 : kept)) count = merge_pairs<Costs>(job, clusters, count, lane);
  if (is_whole) {
    if (lane == 0) {
      const Cluster& whole = clusters.cluster[0];
      *job.root = whole.ref;
      store_wide(&job.nodes[whole.node_index], BuildNode{{}, no_node, {}, no_node});
    }
  } else if (lane < kept) {  // the range has room for more than that
    job.pairs[first + lane] = pack(lane < count ? clusters.cluster[lane] : Cluster{nobody, 0});
  }
  __syncwarp();  // the clusters may be overwritten
}

template <class Costs>
__global__ void __launch_bounds__(hploc_block) cluster_ranges(HierarchyJob job) {
  __shared__ WarpClusters clusters_of_warp[hploc_block / 32];
  WarpClusters& clusters = clusters_of_warp[threadIdx.x / 32];
  const int lane = threadIdx.x % 32;
  const std::uint32_t leaf = blockIdx.x * blockDim.x + threadIdx.x;
  std::uint32_t first = leaf, last = leaf, split = 0;
  bool climbs = leaf < job.count;
  while (__any_sync(all_lanes, climbs)) {
    if (climbs) {
      const bool is_left = job.prefixes[last + 1] > job.prefixes[first];
      const std::uint32_t node = is_left ? last : first - 1;
      const std::uint32_t other = atomicExch(&job.ranges[node], is_left ? first : last);
      if (other == nobody) {
        climbs = false;
      } else {
        split = node + 1;
        (is_left ? last : first) = other;
      }
    }
    const std::uint32_t size = last - first + 1;
    const bool is_whole = climbs && size == job.count;
    unsigned to_merge = __ballot_sync(all_lanes, climbs && (size > merge_above || is_whole));
    if (to_merge == 0) continue;
    __threadfence();  // what other warps left for these ranges
    for (; to_merge != 0; to_merge &= to_merge - 1) {
      const int from = __ffs(static_cast<int>(to_merge)) - 1;
      merge_range<Costs>(job, __shfl_sync(all_lanes, first, from),
                         __shfl_sync(all_lanes, split, from), __shfl_sync(all_lanes, last, from),
                         clusters, lane);
    }
    __threadfence();  // before the ranges are handed on
    __syncwarp();
    climbs = climbs && !is_whole;
  }
}

__global__ void __launch_bounds__(block_size) make_clusters(HierarchyJob job) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= job.count) return;
  const Cluster leaf{make_ref(1, job.order[i]), i};
  job.pairs[i] = pack(leaf);
  job.ranges[i] = nobody;
  if (job.count == 1) *job.root = leaf.ref;
}

}  // namespace

void enqueue_hploc(const HierarchyJob& job) {
  make_clusters<<<blocks_for(job.count), block_size>>>(job);
  check_cuda(cudaGetLastError(), "make_clusters");
  if (job.count == 1) return;
  const unsigned blocks = (job.count + hploc_block - 1) / hploc_block;
  with_costs(job,
             [&](auto costs) { cluster_ranges<decltype(costs)><<<blocks, hploc_block>>>(job); });
  check_cuda(cudaGetLastError(), "hploc");
}

}  // namespace pt::device_build
