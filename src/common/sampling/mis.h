// Multiple importance sampling (Veach 1997, section 9.2).
#pragma once

#include "common/platform.h"

namespace pt {

/// The power heuristic with exponent 2 for one sample of each of two densities.
/// `chosen` is the density that made the sample; an infinite one (a delta) gets weight 1.
PT_HD float power_heuristic(float chosen, float other) {
  if (chosen == HUGE_VALF) return 1.0f;
  const float a = multiply_rounded(chosen, chosen);
  const float b = multiply_rounded(other, other);
  return a > 0.0f ? a / (a + b) : 0.0f;
}

}  // namespace pt
