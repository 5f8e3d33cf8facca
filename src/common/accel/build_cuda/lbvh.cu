// The linear BVH: the radix tree of the Morton codes, built bottom-up in one pass (Apetrei 2014,
// 'Fast and Simple Agglomerative LBVH Construction').
#include "common/accel/build_cuda/costs.cuh"

namespace pt::device_build {
namespace {

constexpr unsigned long long nobody = ~0ull;

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
    if (other == nobody) return;
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

}  // namespace pt::device_build
