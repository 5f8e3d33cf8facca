// The kernel of the block-local wavefront, for the files that instantiate it.
#pragma once

#include "common/block_wavefront/block_wavefront.cuh"
#include "common/block_wavefront/block_wavefront_cuda.h"
#include "common/device/cuda/stage_stamp.cuh"
#include "common/plan/execution_plan.h"

namespace pt {

template <Geometry geometry, bool has_masks = false, bool has_media = false,
          bool has_motion = false>
using BlockWavefrontTraits =
    Traits<Accel::cwbvh, geometry, Lighting::full, has_masks, has_media, false, has_motion>;

template <class Traits>
using BlockMemory = BlockWavefrontMemory<BlockWavefrontLane<Traits>, block_wavefront_threads>;

/// Paths of a batch, or those of `begun`. `stage`: what its time counts for. `carries`: the paths
/// carry extra records.
template <class Traits, bool carries>
__global__ void __launch_bounds__(block_wavefront_threads, 1)
    block_wavefront(const __grid_constant__ Scene scene, const __grid_constant__ SampleBuffer batch,
                    const __grid_constant__ SamplerSource source,
                    const __grid_constant__ PathSettings settings,
                    const __grid_constant__ PathShare paths,
                    const __grid_constant__ BegunPaths begun, StageId stage, StageClock* clock) {
  using Memory = BlockMemory<Traits>;
  extern __shared__ uint4 block_wavefront_memory[];
  stamp_first_thread(clock, stage);
  uint2 stack[block_wavefront_stack_size<BlockWavefrontLane<Traits>>];
  BlockWavefront<Traits, SamplerSource, Memory, carries> tracer(
      scene, source, batch, settings, paths, *reinterpret_cast<Memory*>(block_wavefront_memory),
      begun.slots.of_block(blockIdx.x), stack);
  tracer.run(begun.count_in(blockIdx.x));
}

/// See BlockWavefrontCode.
template <Geometry geometry, bool has_masks = false, bool has_media = false, bool carries = false,
          bool has_motion = false>
BlockWavefrontCode block_wavefront_code() {
  using Traits = BlockWavefrontTraits<geometry, has_masks, has_media, has_motion>;
  using Memory = BlockMemory<Traits>;
  static_assert(Memory::bytes(block_wavefront_slots_least) <= sorting_bytes_min);
  static_assert(block_wavefront_slots_most == BlockWavefrontTuning::slots_most);
  return {block_wavefront<Traits, carries>, Memory::bytes};
}

}  // namespace pt
