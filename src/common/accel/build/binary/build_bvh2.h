// The binary BVH that rays are traced against.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/nodes.h"
#include "common/geometry/bounds.h"

namespace pt {

struct Bvh2 {
  std::vector<Bvh2Node> nodes;       ///< the root first
  std::vector<std::uint32_t> order;  ///< leaves refer to its elements, primitive indices
};

/// Builds the tree over spheres and quads as that over triangles is built (build_sah()).
/// `bounds[i]` holds primitive i. Primitives below `first_of_second_kind` and the others never
/// share a leaf, and in `order` the first kind comes before the second, so that reordering each
/// kind's array by `order` makes leaves contiguous. Boxes are widened by `padding` on all sides. At
/// least one primitive; the tree is no deeper than bvh_depth_max.
Bvh2 build_bvh2(std::span<const Bounds> bounds, std::uint32_t first_of_second_kind, float padding);

/// Turns a tree of single primitives into a BVH: makes a leaf of every subtree that is cheaper as
/// one; a leaf names a primitive once. The root is node 0 and a node even if all is one leaf, which
/// then is its first child. Primitives below `first_of_second_kind` and the others never share a
/// leaf. Uses up `tree`.
Bvh2 merge_leaves(BinaryTree&& tree, const TreeCosts& costs,
                  std::uint32_t first_of_second_kind = build_primitives_max);

}  // namespace pt
