// The paper's scenes: spheres and quads.
#include "wavefront/wavefront_enqueue.cuh"

namespace pt {

using PhiloxContext = StageContext<PhiloxSource>;
using XorwowContext = StageContext<XorwowSource<CurandState>>;

template void WavefrontCuda::enqueue_wave_of<SphereSceneKinds>(const PhiloxContext&, bool);
template void WavefrontCuda::enqueue_wave_of<BruteSkyKinds>(const XorwowContext&, bool);
template void WavefrontCuda::enqueue_finish_of<SphereSceneKinds>(const PhiloxContext&);
template void WavefrontCuda::enqueue_finish_of<BruteSkyKinds>(const XorwowContext&);

}  // namespace pt
