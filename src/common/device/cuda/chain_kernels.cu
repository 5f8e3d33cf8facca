#include "common/device/cuda/block_tally.cuh"
#include "common/device/cuda/chain_kernels.cuh"
#include "common/device/cuda/stage_stamp.cuh"

namespace pt {
namespace {

__device__ std::uint32_t stamped_thread(StageClock* clock) {
  stamp_first_thread(clock, StageId::mutate);
  return blockIdx.x * blockDim.x + threadIdx.x;
}

}  // namespace

__global__ void __launch_bounds__(1024) propose_bootstrap(Proposal* proposals, std::uint32_t first,
                                                          std::uint32_t count, StageClock* clock) {
  const std::uint32_t i = stamped_thread(clock);
  if (i < count) store_wide(&proposals[i], bootstrap_path(first + i));
}

__global__ void __launch_bounds__(1024)
    keep_targets(float* targets, const __grid_constant__ SampleBuffer batch, PathTally* tally,
                 StageClock* clock) {
  const std::uint32_t i = stamped_thread(clock);
  __shared__ BlockTally block;
  block.begin();
  if (i < batch.path_count) {
    const Sample sample = load_wide(&batch.samples[i]);
    PathTally mine;  // its lengths are not used: those of all threads go to shared memory
    count_sample(sample, mine, [](int bin) { block.count(bin); });
    block.add(mine);
    targets[i] = target_of(sample);
  }
  block.end(tally);
}

__global__ void __launch_bounds__(1024)
    splat_bootstrap_paths(const __grid_constant__ ChainArrays arrays,
                          const __grid_constant__ SampleBuffer batch,
                          const __grid_constant__ ChainStep step, StageClock* clock) {
  const std::uint32_t i = stamped_thread(clock);
  if (i >= batch.path_count) return;
  splat_bootstrap(arrays, step, load_wide(&arrays.proposals[i]), load_wide(&batch.samples[i]));
}

__global__ void __launch_bounds__(1024) sum_groups(const __grid_constant__ Bootstrap bootstrap,
                                                   std::uint32_t paths, StageClock* clock) {
  const std::uint32_t group = stamped_thread(clock);
  if (group >= Bootstrap::group_count(paths)) return;
  bootstrap.groups[group] = sum_group(bootstrap, group, paths);
}

__global__ void __launch_bounds__(1024)
    propose_starts(const __grid_constant__ ChainArrays arrays,
                   const __grid_constant__ ChainPositions positions, StageClock* clock) {
  const std::uint32_t chain = stamped_thread(clock);
  if (chain >= positions.chains) return;
  store_wide(&arrays.proposals[chain],
             bootstrap_path(start_of(arrays.bootstrap, positions, chain)));
}

__global__ void __launch_bounds__(1024)
    step_chains(const __grid_constant__ ChainArrays arrays,
                const __grid_constant__ SampleBuffer batch, const __grid_constant__ ChainStep step,
                StageClock* clock) {
  const std::uint32_t chain = stamped_thread(clock);
  if (chain >= batch.path_count) return;
  step_chain(arrays, step, chain, load_wide(&batch.samples[chain]));
}

__global__ void __launch_bounds__(1024)
    finish_all_chains(const __grid_constant__ ChainArrays arrays, std::uint32_t chains,
                      const __grid_constant__ ChainStep step, StageClock* clock) {
  const std::uint32_t chain = stamped_thread(clock);
  if (chain < chains) finish_chain(arrays, step, chain);
}

}  // namespace pt
