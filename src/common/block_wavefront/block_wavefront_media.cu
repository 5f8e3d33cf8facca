// Scenes of triangles alone, with media, and perhaps with masks.
#include "common/block_wavefront/block_wavefront_kernel.cuh"

namespace pt {

BlockWavefrontKernel media_block_wavefront_kernel() {
  return block_wavefront<BlockWavefrontTraits<true, true>>;
}

}  // namespace pt
