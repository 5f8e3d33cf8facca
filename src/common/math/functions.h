// Sine and cosine of a fraction of a turn, the same polynomial on every device.
#pragma once

#include "common/platform/platform.h"

namespace pt {

struct SinCos {
  float sin, cos;
};

/// sin and cos of 2 pi u for u in [0, 1], absolute error below 3e-7. The libraries' versions differ
/// between CPU and GPU and reduce arguments that never come here.
PT_HD SinCos sincos_2pi(float u) {
  const float quadrant = floorf(4.0f * u + 0.5f);
  const float r = u - 0.25f * quadrant;  // exact; in [-1/8, 1/8] turns
  const float x = 6.28318530717958648f * r;
  const float x2 = x * x;
  // Taylor terms up to x^9 and x^8: the remainder at pi/4 is below 2e-9 and 3e-8.
  const float s =
      x +
      x * x2 * (-1.6666667e-1f + x2 * (8.3333333e-3f + x2 * (-1.9841270e-4f + x2 * 2.7557319e-6f)));
  const float c =
      1.0f + x2 * (-0.5f + x2 * (4.1666667e-2f + x2 * (-1.3888889e-3f + x2 * 2.4801587e-5f)));
  const int q = static_cast<int>(quadrant) & 3;
  const float swapped_s = (q & 1) ? c : s;
  const float swapped_c = (q & 1) ? s : c;
  return {(q & 2) ? -swapped_s : swapped_s, ((q + 1) & 2) ? -swapped_c : swapped_c};
}

}  // namespace pt
