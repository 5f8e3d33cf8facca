// Scenes with media.
#include "wavefront/wavefront_enqueue.cuh"

namespace pt {

using SamplerContext = StageContext<SamplerSource>;

template void WavefrontCuda::enqueue_wave_of<MediaSceneKinds>(const SamplerContext&, bool);
template void WavefrontCuda::enqueue_finish_of<MediaSceneKinds>(const SamplerContext&);

}  // namespace pt
