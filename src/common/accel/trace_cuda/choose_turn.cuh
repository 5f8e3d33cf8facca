// What a warp does next whose lanes want different things.
#pragma once

#include "common/platform.h"

namespace pt {

/// Whether all go a step, of those that want a step or a test, which takes longer.
__device__ inline bool warp_steps(int stepping, int testing) { return stepping >= 2 * testing; }

/// Likewise where there are instances. Found by simulation, as warp_steps.
enum class Turn { step, test, enter };
__device__ inline Turn choose_turn(int stepping, int testing, int entering) {
  if (warp_steps(stepping, max(testing, entering))) return Turn::step;
  return testing >= entering ? Turn::test : Turn::enter;
}

}  // namespace pt
