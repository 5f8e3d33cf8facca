// Ray-sphere intersection, robust for small distant and for very large spheres.
#pragma once

#include "common/geometry/ray.h"

namespace pt {

/// 16 bytes, one load. The square of the radius is what the intersection needs.
struct alignas(16) Sphere {
  Vec3 center;
  float radius_squared;

  PT_HD float radius() const { return fast_sqrt(radius_squared); }
};

/// Distance to the nearest intersection with t > 0; a value <= 0 when there is none. The
/// discriminant is computed from the vector between the centre and the line's nearest point, not as
/// b^2 - c, whose two terms cancel (Haines, Guenther and Akenine-Moeller 2019, Ray Tracing Gems,
/// chapter 7).
PT_HD float sphere_distance(const Sphere& sphere, const Ray& ray) {
  const Vec3 oc = sphere.center - ray.origin;
  const float b = glm::dot(oc, ray.direction);
  const Vec3 off = oc - b * ray.direction;
  const float discriminant = sphere.radius_squared - off.x * off.x - off.y * off.y - off.z * off.z;
  const float half_chord = fast_sqrt(discriminant);
  const float near = b - half_chord;
  // Without a branch: where a warp tests candidates one of its rays meets a sphere mostly.
  return select(discriminant<0.0f, -1.0f, near> 0.0f ? near : b + half_chord);
}

/// The point of the surface nearest to the ray's point at `t`.
PT_HD SurfacePoint sphere_surface(const Sphere& sphere, const Ray& ray, float t) {
  const Vec3 normal = normalize(ray.origin + t * ray.direction - sphere.center);
  const float radius = sphere.radius();
  return {sphere.center + radius * normal, normal,
          8.0f * half_ulp * 2.0f * (max_abs(sphere.center) + radius)};
}

}  // namespace pt
