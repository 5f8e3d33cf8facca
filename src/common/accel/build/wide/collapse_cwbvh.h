// Turns a binary tree of single primitives into the cheapest compressed wide one.
#pragma once

#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/cwbvh.h"

namespace pt {

struct Cwbvh {
  std::vector<CwbvhNode> nodes;      ///< the root first
  std::vector<std::uint32_t> order;  ///< slot -> primitive
};

/// Of all wide trees whose nodes' and leaves' boxes are those of `tree`, the one of least cost
/// (Ylitie et al. 2017, section 3). Leaves have up to min(costs.leaf_max, cwbvh_leaf_max)
/// primitives, each once. The root is a node even where a leaf would do.
Cwbvh collapse_cwbvh(const BinaryTree& tree, const TreeCosts& costs);

}  // namespace pt
