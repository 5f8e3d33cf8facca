// Scenes of triangles alone, without masks, by blocks that sort their paths.
#include "megakernel/sorting_kernel.cuh"

namespace pt {

int MegakernelCuda::block_wavefront_slots() const {
  using Memory = BlockMemory<BlockWavefrontTraits<false>>;
  static_assert(Memory::bytes(1) == BlockMemory<BlockWavefrontTraits<true>>::bytes(1));
  constexpr int least = 4;
  static_assert(Memory::bytes(least) <= sorting_bytes_min);
  int slots = BlockWavefrontTuning::slots_most;
  while (slots > least && Memory::bytes(slots) > properties_.sharedMemPerBlockOptin) --slots;
  return slots;
}

template void MegakernelCuda::allocate_slots<false>();
template void MegakernelCuda::launch_block_wavefront<false>(const SamplerSource&,
                                                            const SampleBuffer&);

}  // namespace pt
