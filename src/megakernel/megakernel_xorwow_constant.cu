#include "megakernel/megakernel_launch.cuh"

template void pt::MegakernelCuda::launch_megakernel(const SceneStorage<SceneMemory::constant>&,
                                                    std::size_t, const XorwowSource<CurandState>&,
                                                    const SampleBuffer&);
