// The phase that a warp executes next when its lanes are ready for different ones.
#pragma once

#include "common/platform/platform.h"

namespace pt {

/// Whether lanes step rather than test, which takes longer; the others of the warp wait.
__device__ inline bool warp_steps(int stepping, int testing) { return stepping >= 2 * testing; }

/// Likewise where there are instances, or where lanes speculate, of which some want both: a test
/// that comes too late lets these wait. Found by simulation, as warp_steps, and by measurement.
enum class Phase { step, test, enter };
template <class Lane>
__device__ Phase choose_phase(int stepping, int testing, int entering) {
  const bool steps = Lane::is_speculative ? 2 * stepping >= 3 * testing
                                          : warp_steps(stepping, max(testing, entering));
  if (steps) return Phase::step;
  return testing >= entering ? Phase::test : Phase::enter;
}

}  // namespace pt
