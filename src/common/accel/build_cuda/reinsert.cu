// Launches of parallel reinsertion (reinsertion.h) after H-PLOC.
#include "common/accel/build_cuda/launch.cuh"

namespace pt::device_build {
namespace {

__global__ void __launch_bounds__(block_size) link_all(const __grid_constant__ ReinsertionJob job) {
  const std::uint32_t node = blockIdx.x * blockDim.x + threadIdx.x;
  if (node < job.count) link_children(job, node);
}

__device__ inline void lock_links_atomically(const ReinsertionJob& job, std::uint32_t i) {
  lock_links(job, i, [](std::uint64_t* lock, std::uint64_t key) {
    atomicMax(reinterpret_cast<unsigned long long*>(lock), key);
  });
}

/// A step of a pass, by one thread per candidate: a kernel each, which needs all of the step
/// before.
template <void (*step)(const ReinsertionJob&, std::uint32_t)>
__global__ void __launch_bounds__(block_size)
    reinsertion_step(const __grid_constant__ ReinsertionJob job) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < job.candidates()) step(job, i);
}

/// For refit_upwards: nodes and their costs in device memory.
template <class Costs>
struct Refitter {
  const ReinsertionJob& job;
  const HierarchyJob& hierarchy;

  __device__ bool arrives_second(std::uint32_t* arrivals) const {
    __threadfence();  // before the exchange: whoever sees it sees the subtree
    const bool is_second = (atomicXor(arrivals, 1u) & 1u) != 0;
    if (is_second) __threadfence();
    return is_second;
  }
  __device__ BuildNode load(TreeRef ref) const {
    return load_fresh(job.primitives, job.nodes, ref);
  }
  __device__ void finish(std::uint32_t index, const BuildNode& node, const Bounds& left,
                         const Bounds& right) const {
    store_wide(&job.nodes[index], node);
    Costs::join(hierarchy, index, costs_of<Costs>(hierarchy, node.left, left),
                costs_of<Costs>(hierarchy, node.right, right), node.bounds().half_area(),
                ref_count(node.left) + ref_count(node.right));
  }
};

template <class Costs>
__global__ void __launch_bounds__(block_size)
    refit_all(const __grid_constant__ ReinsertionJob job,
              const __grid_constant__ HierarchyJob hierarchy) {
  const std::uint32_t primitive = blockIdx.x * blockDim.x + threadIdx.x;
  if (primitive < job.count) refit_upwards(job, primitive, Refitter<Costs>{job, hierarchy});
}

void make_moves(const ReinsertionJob& job) {
  check_cuda(cudaMemsetAsync(job.locks, 0, 2 * std::uint64_t{job.count} * sizeof *job.locks),
             "clear locks");
  const unsigned blocks = blocks_for(job.candidates());
  reinsertion_step<find_move><<<blocks, block_size>>>(job);
  reinsertion_step<lock_links_atomically><<<blocks, block_size>>>(job);
  reinsertion_step<claim_links><<<blocks, block_size>>>(job);
  reinsertion_step<break_cycles><<<blocks, block_size>>>(job);
  reinsertion_step<apply_move><<<blocks, block_size>>>(job);
}

}  // namespace

void enqueue_reinsertion(ReinsertionJob job, const HierarchyJob& hierarchy) {
  const std::uint64_t count = job.count;
  check_cuda(cudaMemsetAsync(job.parents, 0xff, 2 * count * sizeof *job.parents), "clear parents");
  check_cuda(cudaMemsetAsync(job.arrivals, 0, count * sizeof *job.arrivals), "clear arrivals");
  const unsigned blocks = blocks_for(count);
  link_all<<<blocks, block_size>>>(job);
  for (int pass = 0; pass < reinsertion_passes; ++pass) {
    job.first = static_cast<std::uint32_t>(pass) % reinsertion_stride;
    make_moves(job);
    if (pass + 1 < reinsertion_passes) {
      refit_all<NoCosts><<<blocks, block_size>>>(job, hierarchy);
    }
  }
  with_costs(hierarchy, [&](auto costs) {
    refit_all<decltype(costs)><<<blocks, block_size>>>(job, hierarchy);
  });
  check_cuda(cudaGetLastError(), "reinsertion");
}

}  // namespace pt::device_build
