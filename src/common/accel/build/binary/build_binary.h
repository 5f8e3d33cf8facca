// Builds a binary tree on the CPU with the binned surface area heuristic (Wald 2007, 'On fast
// Construction of SAH-based Bounding Volume Hierarchies'), on all of the processor's threads.
#pragma once

#include <functional>

#include "common/accel/build/binary/binary_tree.h"

namespace pt {

/// A primitive's box by its index, from several threads at once.
using BoundsOf = std::function<Bounds(std::uint32_t)>;

/// 1..build_primitives_max primitives, their coordinates within 1e12. The tree is no deeper than
/// bvh_depth_max and does not depend on the number of threads.
BinaryTree build_sah(std::uint32_t count, const BoundsOf& bounds_of);

}  // namespace pt
