// cuRAND's XORWOW generator as a state of XorwowSource: the seed's random numbers.
#pragma once

#include <curand_kernel.h>

#include "common/sampling/random.h"

namespace pt {

struct CurandState {
  curandStateXORWOW_t state;
};

__device__ inline std::uint32_t xorwow_next(CurandState& state) { return curand(&state.state); }

}  // namespace pt
