// Marsaglia's xorwow generator with stored state, equal bit for bit to cuRAND's XORWOW.
// Marsaglia 2003, 'Xorshift RNGs', JSS 8(14). The CPU's counterpart of curandStateXORWOW_t.
#pragma once

#include "common/platform/platform.h"

namespace pt {

struct XorwowState {
  std::uint32_t x[5];
  std::uint32_t weyl;
};

/// The state after cuRAND's curand_init(seed, 0, 0).
PT_HD void xorwow_init(std::uint64_t seed, XorwowState& state) {
  const std::uint32_t t0 = (static_cast<std::uint32_t>(seed) ^ 0xaad26b49u) * 1099087573u;
  const std::uint32_t t1 = (static_cast<std::uint32_t>(seed >> 32) ^ 0xf7dcefddu) * 2591861531u;
  state = {{123456789u + t0, 362436069u ^ t0, 521288629u + t1, 88675123u ^ t1, 5783321u + t0},
           6615241u + t1 + t0};
}

PT_HD std::uint32_t xorwow_next(XorwowState& state) {
  const std::uint32_t t = state.x[0] ^ (state.x[0] >> 2);
  state.x[0] = state.x[1];
  state.x[1] = state.x[2];
  state.x[2] = state.x[3];
  state.x[3] = state.x[4];
  state.x[4] = (state.x[4] ^ (state.x[4] << 4)) ^ (t ^ (t << 1));
  state.weyl += 362437u;
  return state.x[4] + state.weyl;
}

}  // namespace pt
