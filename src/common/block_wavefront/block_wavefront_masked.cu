// Scenes of triangles alone, with masks.
#include "common/block_wavefront/block_wavefront_kernel.cuh"

namespace pt {

BlockWavefrontKernel masked_block_wavefront_kernel() {
  return block_wavefront<BlockWavefrontTraits<true>>;
}

}  // namespace pt
