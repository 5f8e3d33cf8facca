#include "common/scene/prepare/light_errors.h"

#include <algorithm>

namespace pt {
namespace {

Affine without_translation(Affine map) {
  for (Vec4& row : map.row) row.w = 0.0f;
  return map;
}

/// On slivers Embree's distances are uncertain by the longest edge over the height, but no more
/// than this. (Our own test's are not: see hit_error_distance.)
constexpr float aspect_max = 1024.0f;

}  // namespace

PlacementErrors::PlacementErrors(const Affine* to_world) : placed_(to_world != nullptr) {
  if (!placed_) return;
  to_world_ = *to_world;
  to_object_ = inverse(*to_world);
  linear_ = without_translation(to_world_);
  condition_ = max_abs(linear_.absolute(without_translation(to_object_).absolute(Vec3(1.0f))));
}

LightError PlacementErrors::of_triangle(const Vec3 vertices[3], const Vec3& edge1,
                                        const Vec3& edge2) const {
  const Vec3 normal = glm::cross(edge1, edge2);
  const float area = glm::length(normal);  // twice
  const float edge = std::max({glm::length(edge1), glm::length(edge2), glm::length(edge2 - edge1)});
  if (!(area > 0.0f)) return {};
  const float aspect = std::clamp(edge * edge / area, 1.0f, aspect_max);
  LightError error{light_rounding * edge * aspect, light_rounding * condition_};
  if (placed_) {
    // A map of a point rounds up to 4 times, its own numbers have been rounded once, and the
    // shadow ray is another one: half an ulp each of the terms' sizes.
    Vec3 size(0.0f);
    for (int i = 0; i < 3; ++i) size = glm::max(size, glm::abs(vertices[i]));
    const Vec3 in_world = to_world_.absolute(size);
    const Vec3 terms = in_world + linear_.absolute(to_object_.absolute(in_world));
    error.absolute += 8.0f * half_ulp * glm::dot(glm::abs(normal) / area, terms);
  }
  return error;
}

}  // namespace pt
