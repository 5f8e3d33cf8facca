// Where a path's random numbers come from. Drawn four at a time, Philox's natural unit: block 2k
// decides where the path goes after its k-th ray (k = 0: the camera ray), block 2k+1 which light is
// sampled. The numbers depend on (seed, pixel, sample, block) and on nothing else.
#pragma once

#include "common/math/vec.h"
#include "common/sampling/philox.h"
#include "common/sampling/warp.h"
#include "common/sampling/xorwow.h"

namespace pt {

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
