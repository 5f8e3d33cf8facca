// The paper's scenes, in global memory.
#include "megakernel/megakernel_launch.cuh"

namespace pt {

template void MegakernelCuda::launch_megakernel(const SceneStorage<SceneMemory::global>&,
                                                std::size_t, const PhiloxSource&,
                                                const SampleBuffer&);

}  // namespace pt
