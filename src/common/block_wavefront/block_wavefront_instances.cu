// Scenes of triangles and instances of triangles, without masks.
#include "common/block_wavefront/block_wavefront_kernel.cuh"

namespace pt {

BlockWavefrontCode code_for_instances() { return block_wavefront_code<Geometry::mixed>(); }

}  // namespace pt
