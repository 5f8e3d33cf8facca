#include "common/device/block_tally.cuh"
#include "common/device/chain_kernels.cuh"
#include "common/device/stage_stamp.cuh"

namespace pt {

__global__ void __launch_bounds__(1024)
    step_chains(const __grid_constant__ ChainArrays arrays,
                const __grid_constant__ SampleBuffer batch, const __grid_constant__ ChainStep step,
                PathTally* tally, StageClock* clock) {
  stamp_first_thread(clock, StageId::mutate);
  __shared__ BlockTally paths;
  __shared__ std::uint64_t chains[4];  // a ChainTally, whose members no constructor may set
  static_assert(sizeof(ChainTally) == sizeof chains);
  if (threadIdx.x < 4) chains[threadIdx.x] = 0;
  paths.begin();
  const std::uint32_t chain = blockIdx.x * blockDim.x + threadIdx.x;
  if (chain < batch.path_count) {
    PathTally mine;
    ChainTally steps;
    step_chain(
        arrays, batch, step, chain, mine, steps, [](int bin) { paths.count(bin); },
        [](SplatSum* sum, SplatSum quanta) { add_to(sum, quanta); });
    paths.add(mine);
    const std::uint64_t counts[4] = {steps.large, steps.large_accepted, steps.small,
                                     steps.small_accepted};
    for (int i = 0; i < 4; ++i) {
      if (counts[i] > 0) add_to(&chains[i], counts[i]);
    }
  }
  paths.end(tally);
  std::uint64_t* all[4] = {&arrays.tally->large, &arrays.tally->large_accepted,
                           &arrays.tally->small, &arrays.tally->small_accepted};
  if (threadIdx.x < 4) add_to(all[threadIdx.x], chains[threadIdx.x]);
}

}  // namespace pt
