#include "megakernel/megakernel_launch.cuh"

template void pt::MegakernelCuda::launch_megakernel(const SceneStorage<SceneMemory::shared>&,
                                                    std::size_t, const PhiloxSource&,
                                                    const SampleBuffer&);
