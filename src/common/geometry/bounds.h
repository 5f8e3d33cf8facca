// Axis-aligned boxes.
#pragma once

#include "common/math/vec.h"

namespace pt {

/// Half the surface of a box of this size. The areas of a regular grid's boxes are equal but for
/// rounding, so the trees over it depend on how they are rounded.
PT_HD float half_area_of(const Vec3& size) {
  return fused_multiply_add(size.z, size.x, fused_multiply_add(size.x, size.y, size.y * size.z));
}

struct Bounds {
  Vec3 min{HUGE_VALF};
  Vec3 max{-HUGE_VALF};

  PT_HD void grow(const Vec3& p) { min = glm::min(min, p), max = glm::max(max, p); }
  PT_HD void grow(const Bounds& b) { min = glm::min(min, b.min), max = glm::max(max, b.max); }
  PT_HD Vec3 center() const { return 0.5f * (min + max); }
  PT_HD bool is_empty() const { return !(min.x <= max.x); }
  /// Half the surface area; 0 for empty bounds.
  PT_HD float half_area() const { return is_empty() ? 0.0f : half_area_of(max - min); }
};

}  // namespace pt
