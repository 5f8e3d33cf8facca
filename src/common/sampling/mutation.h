// A small step of one random number of a path (Kelemen et al. 2002, 'A simple and robust mutation
// strategy for the Metropolis light transport algorithm', section 5.1).
#pragma once

#include "common/sampling/warp.h"

namespace pt {

/// How far small steps go: largest * 2^(-u * octaves), u uniform, to either side, so that all
/// orders of magnitude between are as likely.
struct MutationSize {
  float log2_largest = -6.0f;  ///< of the largest step, which is at most 1/2
  float octaves = 4.0f;        ///< between the largest and the smallest
};

/// `largest`: in (0, 1/2]. The smallest step is a sixteenth of it.
inline MutationSize mutation_size(float largest) { return {std::log2(largest), 4.0f}; }

/// x after a step by `u`, both in [0, 1); so is the result, since the unit interval is a circle.
/// The density of a step does not depend on x nor on its sign: a step and its way back are equally
/// likely. All kernels get the same bits, for the stage that accepts a step takes it once more.
PT_HD float mutate(float x, float u, const MutationSize& size) {
  const bool down = u >= 0.5f;
  const float v = down ? 2.0f * u - 1.0f : 2.0f * u;
  const float step = exp2f(add_rounded(size.log2_largest, -multiply_rounded(v, size.octaves)));
  float result = add_rounded(x, down ? -step : step);
  if (result < 0.0f) result = add_rounded(result, 1.0f);
  if (result >= 1.0f) result = add_rounded(result, -1.0f);
  return fminf(fmaxf(result, 0.0f), one_minus_ulp);
}

}  // namespace pt
