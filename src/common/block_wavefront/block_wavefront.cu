// Scenes of triangles alone, without masks.
#include "common/block_wavefront/block_wavefront_kernel.cuh"

namespace pt {

BlockWavefrontCode code_for_triangles() { return block_wavefront_code<Geometry::triangles>(); }

}  // namespace pt
