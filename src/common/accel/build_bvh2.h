// Builds the binary BVH on the CPU with the binned surface area heuristic (Wald 2007, 'On fast
// Construction of SAH-based Bounding Volume Hierarchies').
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/accel/bvh2.h"

namespace pt {

struct Bounds {
  Vec3 min{HUGE_VALF};
  Vec3 max{-HUGE_VALF};

  void grow(const Vec3& p) { min = glm::min(min, p), max = glm::max(max, p); }
  void grow(const Bounds& b) { min = glm::min(min, b.min), max = glm::max(max, b.max); }
  Vec3 center() const { return 0.5f * (min + max); }
  /// Half the surface area; 0 for empty bounds.
  float half_area() const;
};

struct Bvh2 {
  std::vector<Bvh2Node> nodes;       ///< the root first
  std::vector<std::uint32_t> order;  ///< leaves refer to places in it; it holds primitive numbers
};

/// `bounds[i]` holds primitive i. Primitives below `first_of_second_kind` and the others never
/// share a leaf, and in `order` the first kind comes before the second, so that reordering each
/// kind's array by `order` makes leaves contiguous. Boxes are widened by `padding` on all sides. At
/// least one primitive; the tree is no deeper than bvh_depth_max.
Bvh2 build_bvh2(std::span<const Bounds> bounds, std::uint32_t first_of_second_kind, float padding);

}  // namespace pt
