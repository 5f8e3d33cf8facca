// Builds the binary BVH over spheres and quads on the CPU, as that over triangles is built: by the
// binned surface area heuristic on all three axes (build_binary.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/accel/nodes.h"
#include "common/geometry/bounds.h"

namespace pt {

struct Bvh2 {
  std::vector<Bvh2Node> nodes;       ///< the root first
  std::vector<std::uint32_t> order;  ///< leaves refer to its elements, primitive indices
};

/// `bounds[i]` holds primitive i. Primitives below `first_of_second_kind` and the others never
/// share a leaf, and in `order` the first kind comes before the second, so that reordering each
/// kind's array by `order` makes leaves contiguous. Boxes are widened by `padding` on all sides. At
/// least one primitive; the tree is no deeper than bvh_depth_max.
Bvh2 build_bvh2(std::span<const Bounds> bounds, std::uint32_t first_of_second_kind, float padding);

}  // namespace pt
