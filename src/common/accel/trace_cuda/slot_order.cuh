// Which child of a wide node comes first.
#pragma once

#include "common/platform/platform.h"

namespace pt {

/// For the octant of a ray's direction and a set of slots, at [octant << 8 | slots]: the bit of the
/// slot to visit first, that is the one with the least (slot XOR octant); any if there is none. In
/// shared memory: one load instead of a dozen instructions.
struct SlotOrder {
  std::uint8_t first[8 * 256];

  /// By all threads of the block; they must meet before the table is read.
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
