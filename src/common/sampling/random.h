// Random numbers by name: generators, hashes, and the numbers of a path.
#pragma once

#include "common/math/vec.h"
#include "common/platform/platform.h"
#include "common/sampling/warp.h"

namespace pt {

struct Uint4 {
  std::uint32_t x, y, z, w;
};

/// Counter-based random numbers: Philox4x32-10, equal bit for bit to cuRAND's (Salmon et al. 2011,
/// 'Parallel random numbers: as easy as 1, 2, 3', SC'11). Ten rounds over a 128-bit counter with a
/// 64-bit key. cuRAND's curand_init(seed, subsequence, offset) followed by curand4() gives
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

/// Marsaglia's xorwow generator with stored state, equal bit for bit to cuRAND's XORWOW (Marsaglia
/// 2003, 'Xorshift RNGs', JSS 8(14)). The CPU's counterpart of curandStateXORWOW_t.
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

/// Mixes `value` into a hash, for decisions that no sampler's pattern serves; the finalizer is
/// Murmur3's (Appleby 2011).
PT_HD std::uint32_t combine_hash(std::uint32_t hash, std::uint32_t value) {
  hash = (hash ^ value) + 0x9e3779b9u;
  hash = (hash ^ hash >> 16) * 0x85ebca6bu;
  hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
  return hash ^ hash >> 16;
}

// Where a path's random numbers come from. Drawn four at a time, Philox's natural unit: block 2k
// decides where the path goes after its k-th ray (k = 0: the camera ray), block 2k+1 which light is
// sampled. The numbers depend on (seed, pixel, sample, block) and on nothing else.

PT_HD std::uint32_t scatter_block(std::uint32_t rays_traced) { return 2 * rays_traced; }
PT_HD std::uint32_t light_block(std::uint32_t rays_traced) { return 2 * rays_traced + 1; }

/// Identifies a path. `index` is that of its sample in the batch's sample buffer.
struct PathId {
  std::uint32_t pixel;   ///< x | y << 16
  std::uint32_t sample;  ///< counted from the image's first sample
  std::uint32_t index;
};

/// Stateless: every draw is computed from its name alone.
struct PhiloxSource {
  std::uint64_t seed;

  struct Stream {
    static constexpr bool is_specialized = true;  ///< for kernels of the paper's scenes
    std::uint64_t seed;
    std::uint32_t pixel, sample;

    /// `purpose` 0 is draw()'s.
    template <bool specialized = true>
    PT_HD Uint4 bits(std::uint32_t block, std::uint32_t purpose) const {
      return philox4x32_10<specialized>({block, purpose, pixel, sample},
                                        static_cast<std::uint32_t>(seed),
                                        static_cast<std::uint32_t>(seed >> 32));
    }

    template <bool specialized = true>
    PT_HD Vec4 draw(std::uint32_t block) {
      const Uint4 b = bits<specialized>(block, 0);
      return {to_unit_float(b.x), to_unit_float(b.y), to_unit_float(b.z), to_unit_float(b.w)};
    }
  };

  PT_HD Stream open(const PathId& id) const { return {seed, id.pixel, id.sample}; }
  PT_HD void close(const PathId&, const Stream&) const {}
};

/// The seed of a path's own xorwow sequence: 64 bits of Philox, so that no two paths share one.
PT_HD std::uint64_t xorwow_seed(std::uint64_t seed, const PathId& id) {
  const Uint4 bits = philox4x32_10({0, 1, id.pixel, id.sample}, static_cast<std::uint32_t>(seed),
                                   static_cast<std::uint32_t>(seed >> 32));
  return bits.x | std::uint64_t{bits.y} << 32;
}

/// Stored state per path, as in the paper: initialised by `render_init`, loaded before a draw and
/// stored after it. Ignores the block: the sequence is what it is. `State` is XorwowState here or
/// curandStateXORWOW_t on CUDA, with `xorwow_next` found by overload.
template <class State>
struct XorwowSource {
  State* states;  ///< [index of the path in the batch]

  struct Stream {
    static constexpr bool is_specialized = true;
    State state;

    PT_HD Vec4 draw(std::uint32_t /*block*/) {
      Vec4 u;
      for (int i = 0; i < 4; ++i) u[i] = to_unit_float(xorwow_next(state));
      return u;
    }
  };

  PT_HD Stream open(const PathId& id) const { return {states[id.index]}; }
  PT_HD void close(const PathId& id, const Stream& stream) const {
    states[id.index] = stream.state;
  }
};

}  // namespace pt
