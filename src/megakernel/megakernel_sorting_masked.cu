// Scenes of triangles alone, with masks, by blocks that sort their paths.
#include "megakernel/sorting_kernel.cuh"

namespace pt {

template void MegakernelCuda::allocate_slots<true>();
template void MegakernelCuda::launch_block_wavefront<true>(const SamplerSource&,
                                                           const SampleBuffer&);

}  // namespace pt
