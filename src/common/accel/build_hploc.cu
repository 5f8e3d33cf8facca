// H-PLOC: locally-ordered clustering along the radix tree of the Morton codes, in one kernel
// (Benthin, Meister, Barczak, Mehalwal, Tsakok and Kensler 2024, 'H-PLOC: Hierarchical Parallel
// Locally-Ordered Clustering for Bounding Volume Hierarchy Construction').
//
// Each lane climbs the radix tree from its leaf, as in the linear BVH, but only to learn which
// range of leaves a node covers. When a range exceeds `merge_above` leaves, the whole warp takes
// the clusters that are left of both halves and merges neighbours until `kept` of them remain,
// which it leaves for the node above.
//
// Unlike the paper's, nodes are not allocated by a counter: each cluster owns a free place, at
// first its leaf's. A merged node takes the lower member's place, and the cluster keeps the other
// one's. So the tree lies in memory in the same way whatever the order of the threads, close to the
// leaves' order, and without an atomic operation.
#include "common/accel/build_costs.cuh"
#include "common/accel/ploc_pair.h"

namespace pt::device_build {
namespace {

constexpr int kept = 16;  // of a half; two halves fill a warp
constexpr std::uint32_t merge_above = kept;
constexpr unsigned all_lanes = 0xffffffffu;
constexpr std::uint32_t nobody = 0xffffffffu;
constexpr int hploc_block = 128;

struct Cluster {
  TreeRef ref;  // nobody: none
  std::uint32_t place;
};

__device__ std::uint64_t pack(const Cluster& c) {
  return static_cast<std::uint64_t>(c.place) << 32 | c.ref;
}
__device__ Cluster unpack(std::uint64_t bits) {
  return {static_cast<TreeRef>(bits), static_cast<std::uint32_t>(bits >> 32)};
}

__device__ Vec3 shuffle(const Vec3& v, int from) {
  return {__shfl_sync(all_lanes, v.x, from), __shfl_sync(all_lanes, v.y, from),
          __shfl_sync(all_lanes, v.z, from)};
}
__device__ Bounds shuffle(const Bounds& b, int from) {
  return {shuffle(b.min, from), shuffle(b.max, from)};
}
__device__ Cluster shuffle(const Cluster& c, int from) {
  return {__shfl_sync(all_lanes, c.ref, from), __shfl_sync(all_lanes, c.place, from)};
}

// One cluster per lane, in the lanes below `count`.
struct WarpClusters {
  Cluster cluster;
  Bounds box;
  int count;
};

__device__ int find_partner(const WarpClusters& c, int lane) {
  std::uint32_t best = no_pair;
  PT_UNROLL(8)
  for (int distance = 1; distance <= ploc_radius; ++distance) {
    const Bounds other = shuffle(c.box, (lane + distance) & 31);
    std::uint32_t rank = pair_rank(c.box, other, lane, distance);
    if (lane + distance >= c.count) rank = no_pair;
    const std::uint32_t below = __shfl_up_sync(all_lanes, rank, distance);
    best = min(best, lane >= distance ? min(rank, below) : rank);
  }
  return best == no_pair ? lane : pair_partner(best, lane);
}

// Joins the pairs that chose each other, and closes the gaps. Never none: the pair of the least
// rank has chosen each other.
template <class Costs>
__device__ void merge_pairs(const HierarchyJob& job, WarpClusters& c, int lane, int* gather) {
  const int partner = find_partner(c, lane);
  const int its_partner = __shfl_sync(all_lanes, partner, partner & 31);
  const bool pairs = partner != lane && its_partner == lane && lane < c.count;
  const Cluster other = shuffle(c.cluster, partner & 31);
  const Bounds other_box = shuffle(c.box, partner & 31);
  if (pairs && lane < partner) {
    const std::uint32_t size = ref_count(c.cluster.ref) + ref_count(other.ref);
    Bounds box = c.box;
    box.grow(other_box);
    const std::uint32_t place = c.cluster.place;
    store_wide(&job.nodes[place], BuildNode{box.min, c.cluster.ref, box.max, other.ref});
    Costs::join(job, place, costs_of<Costs>(job, c.cluster.ref, c.box),
                costs_of<Costs>(job, other.ref, other_box), box.half_area(), size);
    c.cluster = {make_ref(size, place), other.place};
    c.box = box;
  }
  const bool stays = lane < c.count && !(pairs && lane > partner);
  const unsigned staying = __ballot_sync(all_lanes, stays);
  if (stays) gather[__popc(staying & ((1u << lane) - 1u))] = lane;
  __syncwarp();
  c.count = __popc(staying);
  const int from = lane < c.count ? gather[lane] : lane;
  __syncwarp();  // also makes the nodes and tables known to the other lanes
  c.cluster = shuffle(c.cluster, from);
  c.box = shuffle(c.box, from);
}

// The clusters of leaves [first, split) and [split, last], closed up.
__device__ WarpClusters load_clusters(const HierarchyJob& job, std::uint32_t first,
                                      std::uint32_t split, std::uint32_t last, int lane) {
  const bool is_left = lane < kept;
  const std::uint32_t place = is_left ? first + lane : split + (lane - kept);
  const bool is_inside = place < (is_left ? split : last + 1);
  WarpClusters c;
  c.cluster = is_inside ? unpack(__ldcg(&job.pairs[place])) : Cluster{nobody, 0};
  const unsigned found = __ballot_sync(all_lanes, c.cluster.ref != nobody);
  const int left = __popc(found & 0xffffu);  // each half's clusters come first in it
  c.count = __popc(found);
  c.cluster = shuffle(c.cluster, lane < left ? lane : (lane - left + kept) & 31);
  if (lane < c.count) {
    c.box = load_fresh(job.primitives, job.nodes, c.cluster.ref).bounds();
  }
  return c;
}

template <class Costs>
__device__ void merge_range(const HierarchyJob& job, std::uint32_t first, std::uint32_t split,
                            std::uint32_t last, int lane, int* gather) {
  const bool is_whole = last - first + 1 == job.count;
  WarpClusters c = load_clusters(job, first, split, last, lane);
  while (c.count > (is_whole ? 1 : kept)) merge_pairs<Costs>(job, c, lane, gather);
  if (is_whole) {
    if (lane == 0) *job.root = c.cluster.ref;
  } else if (lane < kept) {  // the range has more places than that
    job.pairs[first + lane] = lane < c.count ? pack(c.cluster) : pack({nobody, 0});
  }
}

template <class Costs>
__global__ void __launch_bounds__(hploc_block) cluster_ranges(HierarchyJob job) {
  __shared__ int gather_of_warp[hploc_block / 32][32];
  int* gather = gather_of_warp[threadIdx.x / 32];
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
                         lane, gather);
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
