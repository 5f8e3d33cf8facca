// The order in which the device builders see the primitives, sorted by Morton codes along a
// space-filling curve, and the pairs that neighbours form in it.
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

/// How long a prefix the sorted neighbours i and i + 1 share, plus 1. The common prefixes are the
/// binary radix tree (Karras 2012, 'Maximizing Parallelism in the Construction of BVHs, Octrees,
/// and k-d Trees'). 0 is left for the two ends of the sequence. Equal codes are told apart by their
/// indices, so that runs of them become balanced trees. At most 64 + 32 + 1.
PT_HD std::uint8_t neighbour_prefix(std::uint64_t code, std::uint64_t next, std::uint32_t i) {
  const int length =
      code != next ? count_leading_zeros_64(code ^ next) : 64 + count_leading_zeros(i ^ (i + 1));
  return static_cast<std::uint8_t>(length + 1);
}

// Pairs of neighbours in locally-ordered clustering (Meister and Bittner 2018, 'Parallel
// Locally-Ordered Clustering for Bounding Volume Hierarchy Construction').

inline constexpr int ploc_radius = 8;  ///< neighbours looked at on either side
inline constexpr std::uint32_t no_pair = 0xffffffffu;

PT_HD int lowest_bit(int x) { return 31 - count_leading_zeros(static_cast<std::uint32_t>(x & -x)); }

/// A pair's rank, the same seen from both members: the area of the joint box, less the last four
/// bits, then the distance in the order, then a bit that tells the two pairs apart that a cluster
/// has at this distance. So every cluster has one best pair, and where all areas are equal (copies
/// of one triangle) clusters pair up two by two instead of forming a chain.
/// `lower` is the index of the member that comes first, 1 <= `distance` <= ploc_radius.
PT_HD std::uint32_t pair_rank(const Bounds& a, const Bounds& b, int lower, int distance) {
  Bounds both = a;
  both.grow(b);
  const std::uint32_t bits =
      float_to_bits(half_area_of(both.max - both.min));  // of NaN, too: large, but never `no_pair`
  const int side = lower >> lowest_bit(distance) & 1;
  return (bits & ~15u) | static_cast<std::uint32_t>((distance - 1) << 1 | side);
}

/// The other member of the pair to which the cluster at `index` belongs.
PT_HD int pair_partner(std::uint32_t rank, int index) {
  const int distance = static_cast<int>(rank >> 1 & 7u) + 1;
  const bool is_lower = (index >> lowest_bit(distance) & 1) == static_cast<int>(rank & 1u);
  return is_lower ? index + distance : index - distance;
}

}  // namespace pt
