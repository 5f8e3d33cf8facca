// The random numbers of a path that a Markov chain proposes (docs/design/metropolis.md).
#pragma once

#include "common/sampling/random.h"
#include "common/sampling/warp.h"

namespace pt {

// A small step of one random number (Kelemen et al. 2002, 'A simple and robust mutation strategy
// for the Metropolis light transport algorithm', section 5.1).

/// How far small steps go: largest * 2^(-u * octaves), u uniform, to either side, so that all
/// orders of magnitude between are equally likely.
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
  const float step = exp2f(size.log2_largest - v * size.octaves);
  float result = x + (down ? -step : step);
  if (result < 0.0f) result += 1.0f;
  if (result >= 1.0f) result -= 1.0f;
  return fminf(fmaxf(result, 0.0f), one_minus_ulp);
}

// They are those of the chain's state, mutated, as far as that path drew them, and fresh ones
// beyond.

/// The random numbers of a chain's next path; 16 bytes, one load.
struct alignas(16) Proposal {
  std::uint32_t path = 0;       ///< the chain's index; of a bootstrap path, its own
  std::uint32_t iteration = 0;  ///< of the chain, from 1; bootstrap_iteration: no chain's
  std::uint32_t blocks = 0;     ///< of random numbers that the chain's state has stored
  std::uint32_t is_large = 0;   ///< all numbers are fresh

  /// The blocks of the state that are mutated.
  PT_HD std::uint32_t kept() const { return is_large != 0 ? 0 : blocks; }
};

/// The paths before the chains: all of their numbers are fresh, by names that no chain has.
inline constexpr std::uint32_t bootstrap_iteration = 0x80000000u;

/// Where in the image a path begins: its pixel, x | y << 16, and its block 0, whose first two
/// numbers place it there.
struct PixelPoint {
  std::uint32_t pixel;
  Vec4 u;
};

/// The pixels over which chains walk.
struct ChainWindow {
  std::uint32_t x = 0, y = 0, width = 1, height = 1;

  /// The first two numbers of block 0 are a point of the window: a pixel, and what is left over
  /// for the position in it, within the precision of a float.
  PT_HD PixelPoint point_of(const Vec4& u) const {
    const float along_x = u.x * static_cast<float>(width);
    const float along_y = u.y * static_cast<float>(height);
    const std::uint32_t column = least(static_cast<std::uint32_t>(along_x), width - 1);
    const std::uint32_t row = least(static_cast<std::uint32_t>(along_y), height - 1);
    return {(x + column) | (y + row) << 16,
            {fminf(along_x - static_cast<float>(column), one_minus_ulp),
             fminf(along_y - static_cast<float>(row), one_minus_ulp), u.z, u.w}};
  }

  /// The index of a pixel in the window, row by row.
  PT_HD std::uint32_t index_of(std::uint32_t pixel) const {
    return ((pixel >> 16) - y) * width + ((pixel & 0xffffu) - x);
  }

 private:
  PT_HD static std::uint32_t least(std::uint32_t a, std::uint32_t b) { return a < b ? a : b; }
};

/// What a path needs of all chains to draw its numbers. Lies in the device's memory, so that a
/// source of numbers is one pointer larger and no more.
struct Chains {
  const Proposal* proposals = nullptr;  ///< [index of the path in the batch]
  const Vec4* accepted = nullptr;       ///< [block][chain]: the states' numbers
  std::uint64_t seed = 0;
  std::uint32_t count = 0;
  MutationSize size;
  ChainWindow window;

  /// Fresh bits of a path; `purpose` 3 is the path's own.
  PT_HD Uint4 bits(std::uint32_t path, std::uint32_t iteration, std::uint32_t block,
                   std::uint32_t purpose) const {
    return philox4x32_10({block, purpose, path, iteration}, static_cast<std::uint32_t>(seed),
                         static_cast<std::uint32_t>(seed >> 32));
  }

  /// A block of the path that is proposed.
  PT_HD Vec4 draw(std::uint32_t path, std::uint32_t iteration, std::uint32_t block) const {
    const Uint4 b = bits(path, iteration, block, 3);
    Vec4 u(to_unit_float(b.x), to_unit_float(b.y), to_unit_float(b.z), to_unit_float(b.w));
    if (iteration == bootstrap_iteration || block >= load_wide(&proposals[path]).kept()) return u;
    const Vec4 x = accepted[std::uint64_t{block} * count + path];
    PT_UNROLL(4)
    for (int i = 0; i < 4; ++i) u[i] = mutate(x[i], u[i], size);
    return u;
  }

  /// The two numbers that decide whether a chain accepts the path, and whether its next step is
  /// large.
  PT_HD Vec2 decide(std::uint32_t path, std::uint32_t iteration) const {
    const Uint4 b = bits(path, iteration, 0, 4);
    return {to_unit_float(b.x), to_unit_float(b.y)};
  }
};

}  // namespace pt
