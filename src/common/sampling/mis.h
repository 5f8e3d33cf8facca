// Multiple importance sampling (Veach 1997, section 9.2).
#pragma once

#include "common/platform.h"

namespace pt {

/// The power heuristic with exponent 2 for one sample of each of two densities.
/// `chosen` is the density that made the sample; an infinite one (a delta) gets weight 1.
PT_HD float power_heuristic(float chosen, float other) {
  if (chosen == HUGE_VALF) return 1.0f;
  if (chosen <= 0.0f) return 0.0f;
  const float ratio = other / chosen;  // squared by itself, a density could leave float's range
  return 1.0f / (1.0f + multiply_rounded(ratio, ratio));
}

}  // namespace pt
