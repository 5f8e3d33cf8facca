// Wide trees of triangles alone, by warp-level phase voting (trace_paths_voting.cuh).
#include "megakernel/megakernel_cuda.h"
#include "megakernel/megakernel_kernel.cuh"
#include "megakernel/trace_paths_voting.cuh"

namespace pt {
namespace {

using PhaseVotingTraits = Traits<Accel::cwbvh, Geometry::triangles, Lighting::full>;

constexpr int blocks_least = 3;  // 80 registers for a thread

/// The shared memory of a block with this many threads.
constexpr std::size_t shared_bytes_of(int threads) {
  return sizeof(SlotOrder) + static_cast<std::size_t>(threads) / 32 * sizeof(PhaseVotingWarp);
}

__global__ void __launch_bounds__(phase_voting_threads_max, blocks_least)
    phase_voting_megakernel(const __grid_constant__ Scene scene,
                            const __grid_constant__ SampleBuffer batch,
                            const __grid_constant__ WorkDivision division,
                            const __grid_constant__ SamplerSource source,
                            const __grid_constant__ PathSettings settings, StageClock* clock) {
  extern __shared__ uint4 phase_voting_memory[];
  static_assert(sizeof(SlotOrder) % sizeof(uint4) == 0);
  SlotOrder& order = *reinterpret_cast<SlotOrder*>(phase_voting_memory);
  auto* const warps =
      reinterpret_cast<PhaseVotingWarp*>(phase_voting_memory + sizeof(SlotOrder) / sizeof(uint4));
  stamp_first_thread(clock, StageId::megakernel);
  order.fill();
  __syncthreads();
  ThreadWork work(division, batch);
  uint2 stack[phase_voting_stack_size];
  PhaseVotingTracer<PhaseVotingTraits, SamplerSource, ThreadWork> tracer(
      scene, source, batch, settings, work, order, warps[threadIdx.x / 32], threadIdx.x % 32,
      stack);
  tracer.run();
}

}  // namespace

void MegakernelCuda::launch_phase_voting(const SamplerSource& source, const SampleBuffer& batch) {
  const int threads = plan_.block.x * plan_.block.y;
  const std::size_t shared_bytes = shared_bytes_of(threads);
  const WorkDivision division{Work::persistent, batch.width.divisor(), batch.height(), next_path_};
  const std::uint32_t blocks = resident_blocks(
      reinterpret_cast<const void*>(phase_voting_megakernel), threads, shared_bytes);
  launch("megakernel", phase_voting_megakernel, blocks, threads, shared_bytes, scene_, batch,
         division, source, path_settings_, clock());
}

}  // namespace pt
