// Rays and hits.
#pragma once

#include "common/math/vec.h"
#include "common/platform/lane_counter.h"

namespace pt {

/// Points origin + t direction with t > 0; `direction` has unit length.
struct Ray {
  Vec3 origin;
  Vec3 direction;
  PT_LANE_COUNTER;
};

inline constexpr std::uint32_t no_primitive = 0xffffffffu;
/// Instead of one where a ray ends in a medium.
inline constexpr std::uint32_t medium_collision = 0xfffffffeu;
inline constexpr float infinite_distance = 3.0e38f;

/// The nearest intersection. Primitives are numbered spheres first, then quads, then the slots of
/// triangles (triangle.h).
struct Hit {
  float t = infinite_distance;
  std::uint32_t primitive = no_primitive;
  std::uint32_t instance = 0;  ///< of the triangle, in scenes with instances

  PT_HD bool is_miss() const { return primitive == no_primitive; }
  PT_HD bool is_collision() const { return primitive == medium_collision; }
};

/// A point on a surface, with what is needed to leave it.
struct SurfacePoint {
  Vec3 position;
  Vec3 normal;        ///< outward geometric normal, unit length
  float error_bound;  ///< how far `position` and the surface may be apart through rounding
};

/// Where a ray from `point` towards `direction` begins, so that it cannot hit the surface it
/// leaves: beyond the rounding error, on the side to which it goes (pbrt-v4, section 6.8.6).
PT_HD Vec3 spawn_origin(const SurfacePoint& point, const Vec3& direction) {
  const float side = dot(direction, point.normal) < 0.0f ? -1.0f : 1.0f;
  const float offset = side * point.error_bound;
  return {fused_multiply_add(offset, point.normal.x, point.position.x),
          fused_multiply_add(offset, point.normal.y, point.position.y),
          fused_multiply_add(offset, point.normal.z, point.position.z)};
}

PT_HD Ray spawn_ray(const SurfacePoint& point, const Vec3& direction) {
  return {spawn_origin(point, direction), direction};
}

}  // namespace pt
