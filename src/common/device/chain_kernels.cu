#include "common/device/chain_kernels.cuh"
#include "common/device/stage_stamp.cuh"

namespace pt {

__global__ void __launch_bounds__(1024)
    step_chains(const __grid_constant__ ChainArrays arrays,
                const __grid_constant__ SampleBuffer batch, const __grid_constant__ ChainStep step,
                StageClock* clock) {
  stamp_first_thread(clock, StageId::mutate);
  const std::uint32_t chain = blockIdx.x * blockDim.x + threadIdx.x;
  if (chain >= batch.path_count) return;
  if (step.kind == ChainStep::Kind::finish) return finish_chain(arrays, step, chain);
  step_chain(arrays, step, chain, load_wide(&batch.samples[chain]));
}

}  // namespace pt
