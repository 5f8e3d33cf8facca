// Turns a tree of single primitives into the binary tree that rays are traced against.
#pragma once

#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/build/binary/build_bvh2.h"

namespace pt {

/// Makes a leaf of every subtree that is cheaper as one; a leaf names a primitive once. The root is
/// node 0 and a node even if all is one leaf, which then is its first child. Primitives below
/// `first_of_second_kind` and the others never share a leaf. Uses up `tree`.
Bvh2 merge_leaves(BinaryTree&& tree, const TreeCosts& costs,
                  std::uint32_t first_of_second_kind = build_primitives_max);

}  // namespace pt
