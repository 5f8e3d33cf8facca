// What the C library has as functions, in a few instructions: a call in the middle of shading costs
// more than itself, for no register of floats survives it. The same bits as the library's, which
// GCC inlines only where it may forget NaN. Code in namespace pt finds these by the usual names.
#pragma once

#include <atomic>
#include <cmath>

namespace pt {

/// The larger; of a number and NaN the number.
inline float fmaxf(float a, float b) { return a > b || b != b ? a : b; }

/// The smaller, likewise.
inline float fminf(float a, float b) { return a < b || b != b ? a : b; }

inline float floorf(float x) {
  if (!(std::fabs(x) < 8388608.0f)) return x;  // 2^23: all are integers, or it is NaN
  const float towards_zero = static_cast<float>(static_cast<int>(x));
  return std::copysign(towards_zero > x ? towards_zero - 1.0f : towards_zero, x);  // for -0
}

}  // namespace pt
