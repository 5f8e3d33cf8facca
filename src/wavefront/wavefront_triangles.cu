// Scenes with triangles.
#include "wavefront/wavefront_enqueue.cuh"

namespace pt {

using PhiloxContext = StageContext<PhiloxSource>;

template void WavefrontCuda::enqueue_wave_of<TriangleSceneKinds>(const PhiloxContext&, bool);
template void WavefrontCuda::enqueue_finish_of<TriangleSceneKinds>(
    const StageContext<AnySource<CurandState>>&);

}  // namespace pt
