// The paper's scenes: spheres and quads.
#include "wavefront/wavefront_enqueue.cuh"

namespace pt {

using PhiloxContext = StageContext<PhiloxSource>;
using XorwowContext = StageContext<XorwowSource<CurandState>>;

using PhiloxKinds = WaveKinds<PhiloxSource>;
using XorwowKinds = WaveKinds<XorwowSource<CurandState>>;

template void WavefrontCuda::enqueue_wave_of<PhiloxKinds>(const PhiloxContext&, bool);
template void WavefrontCuda::enqueue_wave_of<XorwowKinds>(const XorwowContext&, bool);
template void WavefrontCuda::enqueue_finish_of<PhiloxKinds>(const PhiloxContext&);
template void WavefrontCuda::enqueue_finish_of<XorwowKinds>(const XorwowContext&);

}  // namespace pt
