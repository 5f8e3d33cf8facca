// The kernel in which all Markov chains take a step together: they begin, they end, and where none
// goes on by itself they mutate. Seen from C++, a kernel is the function that launches it.
#pragma once

#include <cuda_runtime_api.h>

#include "common/device/stage_clock.h"
#include "common/film/markov_chains.h"

namespace pt {

/// A thread per chain; blocks of at most 1024.
__global__ void step_chains(const __grid_constant__ ChainArrays arrays,
                            const __grid_constant__ SampleBuffer batch,
                            const __grid_constant__ ChainStep step, StageClock* clock);

}  // namespace pt
