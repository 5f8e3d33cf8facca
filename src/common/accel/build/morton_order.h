// Morton codes: points sorted along a space-filling curve, the order in which the device builders
// see the primitives; and the common prefixes of neighbours, which are the binary radix tree
// (Karras 2012, 'Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees').
#pragma once

#include "common/geometry/bounds.h"

namespace pt {

inline constexpr int morton_bits_max = 21;  ///< per axis: three axes fill 63 bits

/// The cubic grid over a box: cells of the same size on all axes, so that the curve prefers no
/// axis of a flat scene. Works on halves, whose differences cannot overflow.
struct MortonGrid {
  Vec3 half_origin{0.0f};
  float scale = 0;  ///< cells per half unit
  float last = 0;   ///< the largest cell number
};

/// 1 <= `bits` <= morton_bits_max, per axis. An empty box or a point gives one cell.
PT_HD MortonGrid make_morton_grid(const Bounds& box, int bits) {
  if (box.is_empty()) return {};
  const Vec3 half_size = 0.5f * box.max - 0.5f * box.min;
  const float size = fmaxf(fmaxf(half_size.x, half_size.y), half_size.z);
  const auto cells = static_cast<float>(1u << bits);
  const float scale = cells / size;
  return {0.5f * box.min, scale < HUGE_VALF ? scale : 0.0f, cells - 1.0f};
}

/// Puts two zeros between the lower 21 bits.
PT_HD std::uint64_t spread_bits(std::uint64_t x) {
  x &= 0x1fffffu;
  x = (x | x << 32) & 0x001f00000000ffffull;
  x = (x | x << 16) & 0x001f0000ff0000ffull;
  x = (x | x << 8) & 0x100f00f00f00f00full;
  x = (x | x << 4) & 0x10c30c30c30c30c3ull;
  return (x | x << 2) & 0x1249249249249249ull;
}

/// Points outside of the grid count as on its border, NaN as 0.
PT_HD std::uint64_t morton_code(const MortonGrid& grid, const Vec3& p) {
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float cell = (0.5f * p[axis] - grid.half_origin[axis]) * grid.scale;
    const auto inside = static_cast<std::uint32_t>(fminf(fmaxf(cell, 0.0f), grid.last));
    code |= spread_bits(inside) << (2 - axis);
  }
  return code;
}

PT_HD int count_leading_zeros_64(std::uint64_t x) {
  const auto high = static_cast<std::uint32_t>(x >> 32);
  return high != 0 ? count_leading_zeros(high)
                   : 32 + count_leading_zeros(static_cast<std::uint32_t>(x));
}

/// How long a prefix the sorted neighbours i and i + 1 share, plus 1: 0 is left for the two ends of
/// the sequence. Equal codes are told apart by their indices, so that runs of them become balanced
/// trees. At most 64 + 32 + 1.
PT_HD std::uint8_t neighbour_prefix(std::uint64_t code, std::uint64_t next, std::uint32_t i) {
  const int length =
      code != next ? count_leading_zeros_64(code ^ next) : 64 + count_leading_zeros(i ^ (i + 1));
  return static_cast<std::uint8_t>(length + 1);
}

}  // namespace pt
