// What shading needs of a triangle besides its vertices.
#pragma once

#include "common/geometry/mesh.h"

namespace pt {

/// The attributes of a triangle's corners, side by side: four 16-byte loads from two sectors of
/// memory. Vertices that triangles share are repeated. Their own arrays would be half as large, but
/// a hit would read 15 words from seven addresses, and their indices before that.
struct alignas(64) CornerAttributes {
  Vec3 normal[3] = {Vec3(0.0f), Vec3(0.0f), Vec3(0.0f)};  ///< unit length, or the mesh has none
  Vec2 uv[3] = {Vec2(0.0f), Vec2(0.0f), Vec2(0.0f)};
  float padding = 0.0f;

  PT_HD Vec3 normal_at(const Vec3& b) const {
    return weighted_sum(b, normal[0], normal[1], normal[2]);
  }
  PT_HD Vec2 uv_at(const Vec3& b) const {
    const Vec3 at = weighted_sum(b, Vec3(uv[0], 0.0f), Vec3(uv[1], 0.0f), Vec3(uv[2], 0.0f));
    return {at.x, at.y};
  }
};
static_assert(sizeof(CornerAttributes) == 64);

}  // namespace pt
