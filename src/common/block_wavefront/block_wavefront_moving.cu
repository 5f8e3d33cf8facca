// Scenes of triangles in which the camera moves, or instances as well, without masks.
#include "common/block_wavefront/block_wavefront_kernel.cuh"

namespace pt {

BlockWavefrontCode code_for_moving_cameras() {
  return block_wavefront_code<Geometry::triangles, false, false, false, true>();
}

BlockWavefrontCode code_for_moving_instances() {
  return block_wavefront_code<Geometry::mixed, false, false, false, true>();
}

}  // namespace pt
