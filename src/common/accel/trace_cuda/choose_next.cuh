// What comes next: the phase of a warp, the child of a wide node.
#pragma once

#include "common/platform/platform.h"

namespace pt {

/// Whether the warp steps down the tree next rather than testing triangles, which takes longer; the
/// lanes that are ready for the other phase wait.
__device__ inline bool warp_steps(int stepping, int testing) { return stepping >= 2 * testing; }

/// The phase of a warp in scenes with instances, or whose lanes speculate: some of these are ready
/// for both phases, and wait if a test comes too late. Found by simulation, as warp_steps, and by
/// measurement.
enum class Phase { step, test, enter };
template <class Lane>
__device__ Phase choose_phase(int stepping, int testing, int entering) {
  const bool steps = Lane::is_speculative ? 2 * stepping >= 3 * testing
                                          : warp_steps(stepping, max(testing, entering));
  if (steps) return Phase::step;
  return testing >= entering ? Phase::test : Phase::enter;
}

/// Which child of a wide node comes first. For the octant of a ray's direction and a set of slots,
/// at [octant << 8 | slots]: the bit of the slot to visit first, that is the one with the least
/// (slot XOR octant); any if there is none. In shared memory: one load instead of a dozen
/// instructions.
struct SlotOrder {
  std::uint8_t first[8 * 256];

  /// Called by all threads of the block, which must synchronize before the table is read.
  __device__ void fill() {
    for (std::uint32_t i = threadIdx.x; i < 8 * 256; i += blockDim.x) {
      const std::uint32_t octant = i >> 8, slots = i & 255u;
      std::uint32_t best = 0;
      for (std::uint32_t k = 8; k-- > 0;)
        if ((slots >> (k ^ octant) & 1u) != 0) best = k ^ octant;
      first[i] = static_cast<std::uint8_t>(1u << best);
    }
  }
};

}  // namespace pt
