// Brute force over spheres that lie elsewhere than in global memory.
#include "megakernel/megakernel_launch.cuh"

namespace pt {

template void MegakernelCuda::launch_megakernel(const SceneStorage<SceneMemory::shared>&,
                                                std::size_t, const PhiloxSource&,
                                                const SampleBuffer&);
template void MegakernelCuda::launch_megakernel(const SceneStorage<SceneMemory::constant>&,
                                                std::size_t, const PhiloxSource&,
                                                const SampleBuffer&);

}  // namespace pt
