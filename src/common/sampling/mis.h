// Multiple importance sampling (Veach 1997, section 9.2) of one light sample and one BSDF sample.
#pragma once

#include "common/choices/choices.h"

namespace pt {

/// The power heuristic with exponent 2 for one sample of each of two densities.
/// `chosen` is the density that made the sample; an infinite one (a delta) gets weight 1.
PT_HD float power_heuristic(float chosen, float other) {
  if (chosen == HUGE_VALF) return 1.0f;
  if (chosen <= 0.0f) return 0.0f;
  const float ratio =
      divide(other, chosen);  // squared by itself, a density could leave float's range
  return divide(1.0f, 1.0f + ratio * ratio);
}

PT_HD float balance_heuristic(float chosen, float other) {
  if (chosen == HUGE_VALF) return 1.0f;
  if (chosen <= 0.0f) return 0.0f;
  return divide(1.0f, 1.0f + divide(other, chosen));
}

/// The weight of a light sample, where `direction` is the density of BSDF sampling for the same
/// direction. MisHeuristic::none: 1, since light sampling alone counts.
PT_HD float light_weight(MisHeuristic heuristic, float light, float direction) {
  if (heuristic == MisHeuristic::power) return power_heuristic(light, direction);
  return heuristic == MisHeuristic::balance ? balance_heuristic(light, direction) : 1.0f;
}

/// The weight of emission that a BSDF sample hit, where `light` is the density of light sampling
/// for the same direction; `direction` is infinite where lights were not sampled.
PT_HD float direction_weight(MisHeuristic heuristic, float direction, float light) {
  if (heuristic == MisHeuristic::power) return power_heuristic(direction, light);
  if (heuristic == MisHeuristic::balance) return balance_heuristic(direction, light);
  return direction == HUGE_VALF ? 1.0f : 0.0f;
}

}  // namespace pt
