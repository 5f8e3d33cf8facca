// Scenes of triangles alone, with masks.
#include "common/block_wavefront/block_wavefront_kernel.cuh"

namespace pt {

BlockWavefrontCode code_for_masks() { return block_wavefront_code<Geometry::triangles, true>(); }

}  // namespace pt
