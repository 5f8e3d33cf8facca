// Makes a finished binary tree cheaper: subtrees are taken out and put in where they cost least
// (Bittner, Hapala and Havran 2013, 'Fast Insertion-Based Optimization of Bounding Volume
// Hierarchies'), those with the largest boxes alone, since these cost most, and found side by side
// (Meister and Bittner 2018, 'Parallel Reinsertion for Bounding Volume Hierarchy Optimization').
#pragma once

#include <optional>

#include "common/accel/build/binary/binary_tree.h"

namespace pt {

/// A tree with the same leaves whose nodes have a lower sum of areas. None where the upper nodes,
/// at most 2^16, would save less than 2.25 %, or where it would be deeper than bvh_depth_max.
/// Does not depend on the number of threads.
std::optional<BinaryTree> reinsert_nodes(const BinaryTree& tree);

}  // namespace pt
