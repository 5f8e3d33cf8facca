// Scenes of triangles and instances of triangles, without masks, which may move.
#include "common/block_wavefront/block_wavefront_kernel.cuh"

namespace pt {

BlockWavefrontCode code_for_instances() { return block_wavefront_code<Geometry::mixed>(); }

BlockWavefrontCode code_for_moving_instances() {
  return block_wavefront_code<Geometry::mixed, false, false, false, true>();
}

}  // namespace pt
