// The CPU's builders of binary trees, on all of the processor's threads.
#pragma once

#include <functional>
#include <optional>

#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/build/binary/split.h"

namespace pt {

/// A primitive's box by its index, from several threads at once.
using BoundsOf = std::function<Bounds(std::uint32_t)>;

/// By the binned surface area heuristic (Wald 2007, 'On fast Construction of SAH-based Bounding
/// Volume Hierarchies'). 1..build_primitives_max primitives, their coordinates within 1e12. The
/// tree is no deeper than bvh_depth_max and does not depend on the number of threads.
BinaryTree build_sah(std::uint32_t count, const BoundsOf& bounds_of);

struct SbvhOptions {
  /// A node is worth a try where the boxes of the best object split's halves share more than this
  /// part of the root's area (Stich et al. 2009: 1e-5).
  float alpha = 1e-5f;
  /// References that may be added, as a part of the triangles' number.
  float duplicates = 1.0f;
};

/// As build_sah(), with spatial splits: large and slanted triangles may lie in several leaves, each
/// with the box of a part of it.
BinaryTree build_sbvh(std::uint32_t count, const TriangleOf& triangle_of,
                      const SbvhOptions& options);

/// Makes a finished tree cheaper: subtrees are taken out and put in where they cost least (Bittner,
/// Hapala and Havran 2013, 'Fast Insertion-Based Optimization of Bounding Volume Hierarchies'),
/// only those with the largest boxes, since these cost most, and found side by side (Meister and
/// Bittner 2018, 'Parallel Reinsertion for Bounding Volume Hierarchy Optimization'). The result is
/// a tree with the same leaves whose nodes have a lower sum of areas. None where the upper nodes,
/// at most 2^16, would save less than 2.25 %, or where it would be deeper than bvh_depth_max.
/// Does not depend on the number of threads.
std::optional<BinaryTree> reinsert_nodes(const BinaryTree& tree);

}  // namespace pt
