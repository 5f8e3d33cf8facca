// Scenes of triangles alone, with media, and perhaps with masks.
#include "common/block_wavefront/block_wavefront_kernel.cuh"

namespace pt {

BlockWavefrontCode code_for_media() {
  return block_wavefront_code<Geometry::triangles, true, true>();
}

}  // namespace pt
