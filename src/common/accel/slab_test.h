// A box test that loses nothing.
//
// A plane's distance (plane - origin) * inverse carries three rounding errors, all relative to the
// distance itself: near and far differ from the truth by a factor within 1 +- 3 half ulps each. So
// scaling the far distance by a little more than twice that makes the test conservative (Ize 2013,
// 'Robust BVH Ray Traversal', JCGT 2:2), wherever the origin lies and whatever the scene's scale.
// The scale used is larger, because the triangle test rounds too and its hits must lie in boxes.
// A direction's zero has an infinite inverse: a ray beside the slab gets infinities of the right
// sign, and one that runs in the plane itself NaN, which the minima and maxima ignore.
#pragma once

#include "common/geometry/ray.h"

namespace pt {

inline constexpr float slab_tolerance = 4.7683716e-7f;  ///< 2^-21

struct SlabTestRay {
  Vec3 origin;
  Vec3 inverse;
};

PT_HD SlabTestRay make_slab_test_ray(const Ray& ray) {
  return {ray.origin, {1.0f / ray.direction.x, 1.0f / ray.direction.y, 1.0f / ray.direction.z}};
}

/// Where a ray is inside of a box; widened.
struct SlabInterval {
  float near, far;
  PT_HD bool is_hit() const { return near <= far; }
};

/// The box is [low, high]; the ray's part is [t_min, t_max], t_min >= 0.
PT_HD SlabInterval intersect_box(const SlabTestRay& ray, const Vec3& low, const Vec3& high,
                                 float t_min, float t_max) {
  const bool x = ray.inverse.x < 0.0f, y = ray.inverse.y < 0.0f, z = ray.inverse.z < 0.0f;
  const float near_x = ((x ? high.x : low.x) - ray.origin.x) * ray.inverse.x;
  const float near_y = ((y ? high.y : low.y) - ray.origin.y) * ray.inverse.y;
  const float near_z = ((z ? high.z : low.z) - ray.origin.z) * ray.inverse.z;
  const float far_x = ((x ? low.x : high.x) - ray.origin.x) * ray.inverse.x;
  const float far_y = ((y ? low.y : high.y) - ray.origin.y) * ray.inverse.y;
  const float far_z = ((z ? low.z : high.z) - ray.origin.z) * ray.inverse.z;
  const float near = max_number(near_x, max_number(near_y, max_number(near_z, t_min)));
  const float far = min_number(far_x, min_number(far_y, min_number(far_z, t_max)));
  return {near, far * (1.0f + slab_tolerance)};
}

}  // namespace pt
