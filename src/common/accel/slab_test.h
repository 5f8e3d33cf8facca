// Box tests that hide no hit.
//
// Where a ray meets a triangle at t there is a point P of the triangle nearby, by
// hit_error_distance and hit_margin (geometry/triangle.h). A box in a tree contains P with
// the margin to spare. A plane's distance (plane - origin) * inverse carries three rounding
// errors, all relative to itself. So the planes where the ray enters lie at no more than t (1 + 21
// half ulps), and those where it leaves at no less than t (1 - 21 half ulps): a tolerance of 42 and
// a few makes the test conservative (Ize 2013, 'Robust BVH Ray Traversal', JCGT 2:2, did so for
// rounding alone), and all boxes around a triangle that is hit are visited, in every tree.
// docs/design/tracing.md has the proof.
//
// A direction's zero has an infinite inverse: a ray beside the slab gets infinities of the right
// sign, and one that runs in the plane itself NaN, which the minima and maxima ignore.
#pragma once

#include "common/geometry/bounds.h"
#include "common/geometry/ray.h"

namespace pt {

inline constexpr float slab_tolerance = 48.0f * half_ulp;

struct SlabTestRay {
  Vec3 origin;
  Vec3 inverse;
};

PT_HD SlabTestRay make_slab_test_ray(const Ray& ray) {
  return {ray.origin, {1.0f / ray.direction.x, 1.0f / ray.direction.y, 1.0f / ray.direction.z}};
}

/// Where a ray is inside of a box.
struct SlabInterval {
  float near = -HUGE_VALF, far = HUGE_VALF;
  PT_HD bool is_hit() const { return near <= far; }
};

/// The part of [t_min, t_max] in which the ray is between the planes of the box [low, high], as it
/// comes out of rounding: no less for a box that contains this one.
PT_HD SlabInterval intersect_slabs(const SlabTestRay& ray, const Vec3& low, const Vec3& high,
                                   float t_min, float t_max) {
  const bool x = ray.inverse.x < 0.0f, y = ray.inverse.y < 0.0f, z = ray.inverse.z < 0.0f;
  const float near_x = ((x ? high.x : low.x) - ray.origin.x) * ray.inverse.x;
  const float near_y = ((y ? high.y : low.y) - ray.origin.y) * ray.inverse.y;
  const float near_z = ((z ? high.z : low.z) - ray.origin.z) * ray.inverse.z;
  const float far_x = ((x ? low.x : high.x) - ray.origin.x) * ray.inverse.x;
  const float far_y = ((y ? low.y : high.y) - ray.origin.y) * ray.inverse.y;
  const float far_z = ((z ? low.z : high.z) - ray.origin.z) * ray.inverse.z;
  return {max_number(near_x, max_number(near_y, max_number(near_z, t_min))),
          min_number(far_x, min_number(far_y, min_number(far_z, t_max)))};
}

/// As intersect_slabs, with the tolerance; t_min >= 0.
PT_HD SlabInterval intersect_box(const SlabTestRay& ray, const Vec3& low, const Vec3& high,
                                 float t_min, float t_max) {
  SlabInterval interval = intersect_slabs(ray, low, high, t_min, t_max);
  interval.far *= 1.0f + slab_tolerance;
  return interval;
}

}  // namespace pt
