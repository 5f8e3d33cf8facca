// A sphere: its intersection, robust for small distant and for very large ones, and its
// orientation.
#pragma once

#include "common/geometry/ray.h"
#include "common/math/transform.h"
#include "common/math/vec.h"

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
  const Vec3 oc = sphere.center - ray.origin, d = ray.direction;
  const float b = dot_from_x(oc, d);
  const Vec3 off = add_scaled(oc, -b, d);
  float discriminant = sphere.radius_squared;
  PT_UNROLL(3)
  for (int i = 0; i < 3; ++i) discriminant = fused_multiply_add(-off[i], off[i], discriminant);
  const float half_chord = fast_sqrt(discriminant), near = b - half_chord;
  // Without a branch: where a warp tests candidates one of its rays mostly hits a sphere.
  const float first = near > 0.0f ? near : b + half_chord;
  return select(discriminant < 0.0f, -1.0f, first);
}

/// The point of the surface nearest to the ray's point at `t`.
PT_HD SurfacePoint sphere_surface(const Sphere& sphere, const Ray& ray, float t) {
  const Vec3 normal = normalize(add_scaled(ray.origin, t, ray.direction) - sphere.center);
  const float radius = sphere.radius();
  return {add_scaled(sphere.center, radius, normal), normal,
          8.0f * half_ulp * 2.0f * (max_abs(sphere.center) + radius)};
}

/// The orientation of a sphere, where it matters: textures, and inward normals.
struct alignas(16) SphereFrame {
  /// The sphere's own axes in the world, of unit length; left-handed where it was mirrored.
  Vec3 x = Vec3(1, 0, 0), y = Vec3(0, 1, 0), z = Vec3(0, 0, 1);
  float side = 1.0f;  ///< -1: its normals point inward

  /// The point at an outward normal in the sphere's own axes.
  PT_HD Vec3 local(const Vec3& normal) const {
    return {dot(normal, x), dot(normal, y), dot(normal, z)};
  }
  PT_HD Vec3 world(const Vec3& v) const { return weighted_sum(v, x, y, z); }
  /// By a map that keeps angles.
  PT_HD void turn(const Affine& map) {
    x = normalize(map.vector(x)), y = normalize(map.vector(y)), z = normalize(map.vector(z));
  }
};

/// The distance of a local point from the axis z.
PT_HD float distance_from_axis(const Vec3& local) {
  return square_root(fused_multiply_add(local.x, local.x, local.y * local.y));
}

/// Mitsuba's coordinates: u goes around z from x towards y; v, as ours does, upwards along z.
PT_HD Vec2 sphere_uv(const Vec3& local) {
  const float turns = 0.5f * inverse_pi * atan2f(local.y, local.x);
  const float from_zenith = atan2f(distance_from_axis(local), local.z);  // exact at the poles
  return {turns < 0.0f ? turns + 1.0f : turns, fused_multiply_add(-inverse_pi, from_zenith, 1.0f)};
}

/// The derivatives of the point by u and by v, on a sphere of this radius (pbrt-v4, section 6.2.2).
PT_HD Vec3 sphere_dp_du(const SphereFrame& frame, const Vec3& local, float radius) {
  const float scale = 2.0f * pi * radius;
  return frame.world({-scale * local.y, scale * local.x, 0.0f});
}
PT_HD Vec3 sphere_dp_dv(const SphereFrame& frame, const Vec3& local, float radius) {
  const float r = distance_from_axis(local), scale = pi * radius;
  const float rise = r > 0.0f ? -scale * (local.z / r) : -scale * local.z;
  return frame.world({rise * local.x, rise * local.y, scale * r});
}

}  // namespace pt
