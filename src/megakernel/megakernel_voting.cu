// Wide trees of triangles alone, by warp-level phase voting (trace_paths_voting.cuh).
#include "common/plan/kernels.h"
#include "megakernel/megakernel_cuda.h"
#include "megakernel/megakernel_kernel.cuh"
#include "megakernel/trace_paths_voting.cuh"

namespace pt {
namespace {

using PhaseVotingTraits = Traits<Accel::cwbvh, Geometry::triangles, Lighting::full>;

constexpr int blocks_least = 3;  // 80 registers for a thread

static_assert(phase_voting_bytes(32, 0) == sizeof(SlotOrder) + sizeof(PhaseVotingWarp));

/// The extra records of a warp's lanes, behind all warps: an array over the lanes for each record.
__device__ ExtraState extra_of_warp(PhaseVotingWarp* warps, std::uint32_t records) {
  static_assert(sizeof(PhaseVotingWarp) % sizeof(ExtraRecord) == 0);
  char* const all = reinterpret_cast<char*>(warps + blockDim.x * blockDim.y / 32);
  constexpr std::uint32_t row = 32 * sizeof(ExtraRecord);
  return {all + threadIdx.x / 32 * records * row, records, sizeof(ExtraRecord), 0, row};
}

/// `carries`: paths carry extra records.
template <bool carries>
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
  ExtraState extra;
  if constexpr (carries) extra = extra_of_warp(warps, settings.extra_records);
  PhaseVotingTracer<PhaseVotingTraits, SamplerSource, ThreadWork, carries> tracer(
      scene, source, batch, settings, work, order, warps[threadIdx.x / 32], threadIdx.x % 32, extra,
      stack);
  tracer.run();
}

}  // namespace

void MegakernelCuda::launch_phase_voting(const SamplerSource& source, const SampleBuffer& batch) {
  if (plan_.path_bytes > 0) return launch_phase_voting_of<has_carrying_kernels>(source, batch);
  launch_phase_voting_of<false>(source, batch);
}

template <bool carries>
void MegakernelCuda::launch_phase_voting_of(const SamplerSource& source,
                                            const SampleBuffer& batch) {
  constexpr auto kernel = phase_voting_megakernel<carries>;
  const int threads = plan_.block.x * plan_.block.y;
  const std::size_t shared_bytes = phase_voting_bytes(threads, plan_.path_bytes);
  const WorkDivision division{Work::persistent, batch.width.divisor(), batch.height(), next_path_};
  const std::uint32_t blocks =
      resident_blocks(reinterpret_cast<const void*>(kernel), threads, shared_bytes);
  launch("megakernel", kernel, blocks, threads, shared_bytes, scene_, batch, division, source,
         path_settings_, clock());
}

}  // namespace pt
