// The compressed wide BVH: eight children in 80 bytes (Ylitie, Karras and Laine 2017, 'Efficient
// Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs').
#pragma once

#include "common/math/vec.h"

namespace pt {

/// The children's boxes lie on a grid of 8 bits per axis: origin + 2^exponent * q. An inner child's
/// meta is 0b001 in the upper three bits and 24 + its slot in the lower five; a leaf's is its
/// number of triangles in unary (1, 3, 7) in the upper three bits and the first one's place,
/// relative to triangle_base, in the lower five; 0: no child. Inner children follow each other in
/// memory from child_base, in the order of their slots, and so do the triangles from triangle_base;
/// slots are chosen so that visiting them by ascending (slot XOR octant) goes roughly from near to
/// far, where bit 0, 1, 2 of the octant is set when the ray's direction is negative in x, y, z.
struct alignas(16) CwbvhNode {
  Vec3 origin;
  std::uint8_t exponent[3];  ///< biased as in a float: scale is bits (exponent << 23)
  std::uint8_t inner_mask;   ///< bit s: the child in slot s is an inner node
  std::uint32_t child_base;
  std::uint32_t triangle_base;
  std::uint8_t meta[8];
  std::uint8_t low_x[8], low_y[8], low_z[8];
  std::uint8_t high_x[8], high_y[8], high_z[8];
};
static_assert(sizeof(CwbvhNode) == 80);

inline constexpr int cwbvh_leaf_max = 3;  ///< triangles in a leaf

}  // namespace pt
