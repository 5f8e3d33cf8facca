// Builds a binary tree with spatial splits: large and slanted triangles may lie in several leaves,
// each with the box of a part of it.
#pragma once

#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/build/binary/spatial_split.h"

namespace pt {

struct SbvhOptions {
  /// A node is worth a try where the boxes of the best object split's halves share more than this
  /// part of the root's area (Stich et al. 2009: 1e-5).
  float alpha = 1e-5f;
  /// References that may be added, as a part of the triangles' number.
  float duplicates = 1.0f;
};

/// As build_sah(), except that several leaves may name a triangle.
BinaryTree build_sbvh(std::uint32_t count, const TriangleOf& triangle_of,
                      const SbvhOptions& options);

}  // namespace pt
