// Scenes of triangles alone, without masks.
#include "common/block_wavefront/block_wavefront_kernel.cuh"
#include "common/plan/execution_plan.h"

namespace pt {

BlockWavefrontKernel block_wavefront_kernel() {
  return block_wavefront<BlockWavefrontTraits<false>>;
}

std::size_t block_wavefront_bytes(int slots_per_thread) {
  using Memory = BlockMemory<BlockWavefrontTraits<false>>;
  static_assert(Memory::bytes(1) == BlockMemory<BlockWavefrontTraits<true>>::bytes(1));
  static_assert(Memory::bytes(block_wavefront_slots_least) <= sorting_bytes_min);
  static_assert(block_wavefront_slots_most == BlockWavefrontTuning::slots_most);
  return Memory::bytes(slots_per_thread);
}

}  // namespace pt
