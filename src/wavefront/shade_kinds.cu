// Kernels for surfaces of one kind of BSDF, in scenes of triangles alone.
#include "wavefront/wavefront_enqueue.cuh"

namespace pt {

template void shade_each_kind<Traits<Accel::brute, Geometry::triangles, Lighting::full>>(
    WavefrontCuda&, const WaveBuffers&, const StageContext<SamplerSource>&, const StageQueues&);

}  // namespace pt
