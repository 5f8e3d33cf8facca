// The nodes of binary and of wide bounding volume hierarchies, as they lie in memory.
#pragma once

#include "common/math/vec.h"

namespace pt {

// The binary BVH: 64 bytes for two children, so that one visit is four 16-byte loads and tests both
// (Aila and Laine 2009, 'Understanding the Efficiency of Ray Traversal on GPUs').

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

// The compressed wide BVH: eight children in 80 bytes, after Ylitie, Karras and Laine 2017
// ('Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs'). Two things differ.
// The steps of a node's grid are not powers of two: a flat child lies exactly on a plane of the
// grid on both sides of the node, as the walls of a room do, and rays that leave it do not hit it.
// And a leaf is one or two triangles, which are tested together: three masks describe the slots.

/// See CwbvhNode::packed.
PT_HD float unpack_cwbvh_step(std::uint32_t packed) { return bits_to_float(packed & 0xffffff00u); }

/// The children's boxes lie on a grid of 8 bits per axis: origin + step * q, to within
/// cwbvh_grid_tolerance of a step. Inner children follow each other in memory from child_base, in
/// the order of their slots, and so do the triangles of leaves from triangle_base; slots are chosen
/// so that visiting them by ascending (slot XOR octant) goes roughly from near to far, where bit 0,
/// 1, 2 of the octant is set when the ray's direction is negative in x, y, z.
struct alignas(16) CwbvhNode {
  Vec3 origin;
  std::uint32_t packed[3];  ///< by axis: the step's upper 24 bits, and a mask
  std::uint32_t child_base;
  std::uint32_t triangle_base;
  std::uint8_t planes[3][16];  ///< by axis: low and high of slot 0, of slot 1, ...

  PT_HD float step(int axis) const { return unpack_cwbvh_step(packed[axis]); }
  PT_HD std::uint32_t inner_mask() const { return packed[0] & 0xffu; }  ///< slots of inner nodes
  PT_HD std::uint32_t leaf_mask() const { return packed[1] & 0xffu; }   ///< slots of leaves
  PT_HD std::uint32_t pair_mask() const { return packed[2] & 0xffu; }   ///< leaves of two
  PT_HD std::uint32_t used_mask() const { return inner_mask() | leaf_mask(); }
};
static_assert(sizeof(CwbvhNode) == 80);

inline constexpr int cwbvh_width = 8;
inline constexpr int cwbvh_leaf_max = 2;                        ///< triangles in a leaf
inline constexpr float cwbvh_grid_tolerance = 4.75f / 4096.0f;  ///< in steps

/// A child of a wide node.
struct CwbvhChild {
  std::uint32_t index;  ///< of an inner node among the nodes, else the first of its slots
  std::uint32_t count;  ///< triangles; 0: an inner node
};

/// The child in `slot`, one of used_mask.
PT_HD CwbvhChild cwbvh_child(const CwbvhNode& node, std::uint32_t slot) {
  const std::uint32_t below = (1u << slot) - 1u;
  if ((node.inner_mask() >> slot & 1u) != 0) {
    return {node.child_base + static_cast<std::uint32_t>(count_bits(node.inner_mask() & below)), 0};
  }
  const int before = count_bits(node.leaf_mask() & below) + count_bits(node.pair_mask() & below);
  return {node.triangle_base + static_cast<std::uint32_t>(before),
          1u + (node.pair_mask() >> slot & 1u)};
}

/// Calls visit(slot, child) for the children by ascending slot.
template <class Visit>
PT_HD void for_each_cwbvh_child(const CwbvhNode& node, Visit&& visit) {
  for (std::uint32_t slot = 0; slot < cwbvh_width; ++slot) {
    if ((node.used_mask() >> slot & 1u) != 0)
      visit(static_cast<int>(slot), cwbvh_child(node, slot));
  }
}

}  // namespace pt
