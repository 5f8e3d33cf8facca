// Builds a binary tree on the CPU with the binned surface area heuristic (Wald 2007, 'On fast
// Construction of SAH-based Bounding Volume Hierarchies'), on all of the processor's threads.
#pragma once

#include <span>

#include "common/accel/binary_tree.h"

namespace pt {

/// `bounds[i]` holds primitive i; 1..tree_primitives_max of them, finite, below 1e18 in size. The
/// tree is no deeper than bvh_depth_max and does not depend on the number of threads.
BinaryTree build_sah(std::span<const Bounds> bounds);

}  // namespace pt
