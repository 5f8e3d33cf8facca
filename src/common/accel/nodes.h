// A lean binary bounding volume hierarchy: 64 bytes for two children, so that one visit is four
// 16-byte loads and tests both (Aila and Laine 2009, 'Understanding the Efficiency of Ray Traversal
// on GPUs').
#pragma once

#include "common/math/vec.h"

namespace pt {

/// A child is an inner node's index, or a leaf: bit 31 set, the number of primitives less one in
/// bits 28..30, the first one's index below. A leaf holds primitives of one kind.
struct alignas(16) Bvh2Node {
  Vec4 xy[2];  ///< per child: min x, max x, min y, max y
  Vec4 z;      ///< min z, max z of child 0, then of child 1
  std::uint32_t child[2];
  std::uint32_t padding[2];
};

inline constexpr std::uint32_t leaf_bit = 0x80000000u;
inline constexpr std::uint32_t leaf_size_max = 8;

PT_HD std::uint32_t make_leaf(std::uint32_t first, std::uint32_t count) {
  return leaf_bit | (count - 1) << 28 | first;
}
PT_HD bool is_leaf(std::uint32_t child) { return (child & leaf_bit) != 0; }
PT_HD std::uint32_t leaf_first(std::uint32_t child) { return child & 0x0fffffffu; }
PT_HD std::uint32_t leaf_count(std::uint32_t child) { return ((child >> 28) & 7u) + 1; }

/// The tree's depth is at most this: the builder keeps it, the traversal's stack relies on it.
inline constexpr int bvh_depth_max = 40;

}  // namespace pt
