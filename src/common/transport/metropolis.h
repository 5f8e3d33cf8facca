// The rules of Metropolis light transport in primary sample space (Kelemen et al. 2002; Veach and
// Guibas 1997; pbrt-v3, section 16.4): which proposals a chain accepts, and what they count.
#pragma once

#include "common/light/light.h"

namespace pt {

/// What chains visit paths in proportion to: the luminance. 0, so that no chain goes there, for
/// black and for what is no number.
PT_HD float chain_target(const Color& radiance) {
  const float target = luminance(radiance);
  return target > 0.0f && target <= 3.4028235e38f ? target : 0.0f;
}

/// The probability that a chain leaves a state for a proposal, both by their targets; `current` is
/// above 0. Steps are as likely as their way back, so that the targets alone decide (Metropolis et
/// al. 1953).
PT_HD float acceptance(float current, float proposal) {
  return proposal < current ? proposal / current : 1.0f;
}

/// How a mutation's path counts towards the image. `brightness`, b: the mean of the target over
/// all random numbers.
struct MutationWeights {
  double brightness = 1.0;
  double large_step_probability = 0.3;

  /// Per radiance of a path of this target that stands for `share` mutations: of the chains, whose
  /// density is target / b, and, in addition, of large steps, whose density is 1: their balance
  /// heuristic (Kelemen et al. 2002, section 5.2).
  PT_HD double weight(float target, double share) const {
    return share / (target / brightness + large_step_probability);
  }
  /// Of a proposal, by its expected value: it is accepted with `accepted`.
  PT_HD double of_proposal(float target, float accepted, bool is_large) const {
    return weight(target, static_cast<double>(accepted) + (is_large ? 1.0 : 0.0));
  }
  /// Of the state that the proposal may replace.
  PT_HD double of_current(float target, float accepted) const {
    return weight(target, 1.0 - static_cast<double>(accepted));
  }
};

}  // namespace pt
