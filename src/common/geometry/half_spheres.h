// Spheres in half precision, for the first pass of brute force on CUDA.
#pragma once

#include "common/platform/platform.h"

namespace pt {

/// Four of them, two in each word. 32 bytes.
struct alignas(16) HalfSpheres {
  static constexpr std::uint32_t count = 4;
  std::uint32_t x[2], y[2], z[2], radius_squared[2];
};

}  // namespace pt
