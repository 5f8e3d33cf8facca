// Scenes with triangles.
#include "megakernel/megakernel_launch.cuh"

namespace pt {

template void MegakernelCuda::launch_megakernel(const SceneStorage<SceneMemory::global>&,
                                                std::size_t, const SamplerSource&,
                                                const SampleBuffer&);

}  // namespace pt
