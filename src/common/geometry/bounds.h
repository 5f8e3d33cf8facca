// Axis-aligned boxes.
#pragma once

#include "common/math/vec.h"

namespace pt {

struct Bounds {
  Vec3 min{HUGE_VALF};
  Vec3 max{-HUGE_VALF};

  PT_HD void grow(const Vec3& p) { min = glm::min(min, p), max = glm::max(max, p); }
  PT_HD void grow(const Bounds& b) { min = glm::min(min, b.min), max = glm::max(max, b.max); }
  PT_HD Vec3 center() const { return 0.5f * (min + max); }
  PT_HD bool is_empty() const { return !(min.x <= max.x); }
  /// Half the surface area; 0 for empty bounds.
  PT_HD float half_area() const {
    const Vec3 size = max - min;
    return is_empty() ? 0.0f : size.x * size.y + size.y * size.z + size.z * size.x;
  }
};

}  // namespace pt
