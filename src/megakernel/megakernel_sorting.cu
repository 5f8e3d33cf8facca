// Scenes of triangles alone, without masks, by blocks that sort their paths.
#include "megakernel/sorting_kernel.cuh"

namespace pt {

int MegakernelCuda::block_wavefront_slots() const {
  using Memory = BlockMemory<BlockWavefrontTraits<false>>;
  static_assert(Memory::bytes(1) == BlockMemory<BlockWavefrontTraits<true>>::bytes(1));
  constexpr int least = 4;
  int slots = BlockWavefrontTuning::slots_most;
  while (slots >= least && Memory::bytes(slots) > properties_.sharedMemPerBlockOptin) --slots;
  return slots >= least ? slots : 0;
}

bool MegakernelCuda::can_sort() const {
  using Masked = Traits<Accel::cwbvh, Geometry::mixed, Lighting::full, true>;
  const bool is_plain = traits_ == BlockWavefrontTraits<false>::value();
  const bool is_masked =
      !scene_.camera.is_limited && traits_ == Masked::value() && scene_.has_only_triangles();
  return (is_plain || is_masked) && options_.work == Work::persistent &&
         block_wavefront_slots() > 0;
}

template void MegakernelCuda::allocate_slots<false>();
template void MegakernelCuda::launch_block_wavefront<false>(const SamplerSource&,
                                                            const SampleBuffer&);

}  // namespace pt
