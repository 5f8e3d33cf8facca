// How locally-ordered clustering compares pairs of neighbours (Meister and Bittner 2018, 'Parallel
// Locally-Ordered Clustering for Bounding Volume Hierarchy Construction').
#pragma once

#include "common/geometry/bounds.h"

namespace pt {

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
  const Vec3 size = both.max - both.min;
  const float area = size.x * size.y + size.y * size.z + size.z * size.x;
  const std::uint32_t bits = float_to_bits(area);  // of NaN, too: large, but never `no_pair`
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
