// A hash of 32 bits.
#pragma once

#include "common/platform/platform.h"

namespace pt {

/// A bijection in which every bit of the result depends on all bits of x (two rounds of
/// multiplication and shift; constants by Wellons' search for low bias).
PT_HD std::uint32_t remix(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ x >> 16;
}

}  // namespace pt
