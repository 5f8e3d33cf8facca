// Scenes of triangles alone, without masks, past which the camera may move.
#include "common/block_wavefront/block_wavefront_kernel.cuh"
#include "common/plan/kernels.h"

namespace pt {

BlockWavefrontCode code_for_triangles() { return block_wavefront_code<Geometry::triangles>(); }

BlockWavefrontCode code_for_moving_cameras() {
  return block_wavefront_code<Geometry::triangles, false, false, false, true>();
}

BlockWavefrontCode code_that_carries() {
  constexpr bool carries = has_carrying_kernels;
  return block_wavefront_code<Geometry::triangles, false, false, carries>();
}

}  // namespace pt
