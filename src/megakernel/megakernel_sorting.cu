// Scenes of triangles alone, without masks, by blocks that sort their paths.
#include "megakernel/sorting_kernel.cuh"

namespace pt {

int MegakernelCuda::sorting_slots() const {
  using Memory = BlockMemory<SortingTraits<false>>;
  static_assert(Memory::bytes(1) == BlockMemory<SortingTraits<true>>::bytes(1));
  constexpr int least = 4;
  static_assert(Memory::bytes(least) <= sorting_bytes_min);
  int slots = SortingTuning::slots_most;
  while (slots > least && Memory::bytes(slots) > properties_.sharedMemPerBlockOptin) --slots;
  return slots;
}

template void MegakernelCuda::allocate_slots<false>();
template void MegakernelCuda::launch_sorting<false>(const SamplerSource&, const SampleBuffer&);

}  // namespace pt
