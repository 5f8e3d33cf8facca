// Counter-based random numbers: Philox4x32-10, equal bit for bit to cuRAND's.
// Salmon et al. 2011, 'Parallel random numbers: as easy as 1, 2, 3', SC'11.
#pragma once

#include "common/platform/platform.h"

namespace pt {

struct Uint4 {
  std::uint32_t x, y, z, w;
};

/// Ten rounds over a 128-bit counter with a 64-bit key. cuRAND's
/// curand_init(seed, subsequence, offset) followed by curand4() gives
/// philox4x32_10({offset/4 lo, offset/4 hi, subsequence lo, hi}, seed lo, seed hi).
/// `specialized`: fewer instructions on CUDA, for the specialised kernels, which draw often; in
/// large ones ptxas would allocate registers worse.
template <bool specialized = false>
PT_HD Uint4 philox4x32_10(Uint4 counter, std::uint32_t key0, std::uint32_t key1) {
  PT_UNROLL(10)
  for (int round = 0; round < 10; ++round) {
    const WideProduct p0 = multiply_wide<specialized>(0xD2511F53u, counter.x);
    const WideProduct p1 = multiply_wide<specialized>(0xCD9E8D57u, counter.z);
    counter = {p1.high ^ counter.y ^ key0, p1.low, p0.high ^ counter.w ^ key1, p0.low};
    key0 += 0x9E3779B9u;
    key1 += 0xBB67AE85u;
  }
  return counter;
}

}  // namespace pt
