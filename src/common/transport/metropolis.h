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

/// How a path counts towards the image that was drawn in one of three ways: by the chains, whose
/// density is target / b, by large steps and by the bootstrap, both of density 1. The balance
/// heuristic (Veach and Guibas 1995) weighs them, as Kelemen et al. (2002, section 5.2) do for the
/// first two. Whatever `expected` is, the weights of the three add up to 1.
struct MutationWeights {
  double brightness = 1.0;  ///< b: the mean of the target over all random numbers
  double expected = 1.0;    ///< b as it was known when the weights were needed
  double large_step_probability = 0.3;
  double bootstrap_share = 0.0;  ///< bootstrap paths for each mutation

  /// Per radiance of a path of this target that stands for `share` paths drawn with density 1.
  PT_HD double weight(float target, double share) const {
    return share / (target / expected + large_step_probability + bootstrap_share);
  }
  /// The same for as many mutations of a chain.
  PT_HD double of_chain(float target, double mutations) const {
    return weight(target, mutations * (brightness / expected));
  }
  /// The weight of a proposal that is accepted with probability `accepted` (its expected value).
  PT_HD double of_proposal(float target, float accepted, bool is_large) const {
    return of_chain(target, static_cast<double>(accepted)) + (is_large ? weight(target, 1.0) : 0.0);
  }
  /// The weight of the state that the proposal may replace.
  PT_HD double of_current(float target, float accepted) const {
    return of_chain(target, 1.0 - static_cast<double>(accepted));
  }
  /// The weight of a bootstrap path, in units of `bootstrap_share` / bootstrap paths.
  PT_HD double of_bootstrap(float target) const { return weight(target, 1.0); }
};

}  // namespace pt
