// The paper's random numbers, for its scenes.
#include "megakernel/megakernel_launch.cuh"

namespace pt {

template void MegakernelCuda::launch_megakernel(const SceneStorage<SceneMemory::global>&,
                                                std::size_t, const XorwowSource<CurandState>&,
                                                const SampleBuffer&);

}  // namespace pt
