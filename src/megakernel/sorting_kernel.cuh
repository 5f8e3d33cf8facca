// The megakernel whose blocks sort their paths, and its launch, for the files that instantiate it.
#pragma once

#include "common/device/cuda/stage_stamp.cuh"
#include "megakernel/megakernel_cuda.h"
#include "megakernel/trace_paths_sorting.cuh"

namespace pt {

/// Of scenes of triangles alone.
template <bool has_masks>
using BlockWavefrontTraits = Traits<Accel::cwbvh, Geometry::triangles, Lighting::full, has_masks>;

/// All that a multiprocessor has room for at 96 registers: so they share the code that is in its
/// instruction cache, and their paths are sorted together (results/ has the measurement).
inline constexpr int block_wavefront_threads = 640;

template <class Traits>
using BlockMemory = BlockWavefrontMemory<BlockWavefrontLane<Traits>, block_wavefront_threads>;

template <class Traits>
__global__ void __launch_bounds__(block_wavefront_threads, 1)
    block_wavefront_megakernel(const __grid_constant__ Scene scene,
                               const __grid_constant__ SampleBuffer batch,
                               const __grid_constant__ SamplerSource source,
                               const __grid_constant__ PathLimits limits,
                               const __grid_constant__ PathShare paths, PathSlot* slots,
                               StageClock* clock) {
  using Memory = BlockMemory<Traits>;
  extern __shared__ uint4 block_wavefront_memory[];
  stamp_first_thread(clock, StageId::megakernel);
  uint2 stack[block_wavefront_stack_size];
  BlockWavefront<Traits, SamplerSource, Memory> tracer(
      scene, source, batch, limits, paths, *reinterpret_cast<Memory*>(block_wavefront_memory),
      slots + std::size_t{blockIdx.x} * block_wavefront_threads * paths.slots_per_thread, stack);
  tracer.run();
}

template <bool has_masks>
std::uint32_t MegakernelCuda::block_wavefront_blocks() {
  using Memory = BlockMemory<BlockWavefrontTraits<has_masks>>;
  const auto* const kernel =
      reinterpret_cast<const void*>(block_wavefront_megakernel<BlockWavefrontTraits<has_masks>>);
  return resident_blocks(kernel, block_wavefront_threads, Memory::bytes(block_wavefront_slots()));
}

template <bool has_masks>
void MegakernelCuda::allocate_slots() {
  slots_ =
      memory_.allocate<PathSlot>("paths", std::uint64_t{block_wavefront_blocks<has_masks>()} *
                                              block_wavefront_threads * block_wavefront_slots());
}

template <bool has_masks>
void MegakernelCuda::launch_block_wavefront(const SamplerSource& source,
                                            const SampleBuffer& batch) {
  using Memory = BlockMemory<BlockWavefrontTraits<has_masks>>;
  const std::uint32_t blocks = block_wavefront_blocks<has_masks>();
  const PathShare paths{next_path_, (batch.path_count + blocks - 1) / blocks,
                        block_wavefront_slots()};
  launch("megakernel", block_wavefront_megakernel<BlockWavefrontTraits<has_masks>>, blocks,
         block_wavefront_threads, Memory::bytes(paths.slots_per_thread), scene_, batch, source,
         limits_, paths, slots_, clock());
}

}  // namespace pt
