// The orientation of a sphere, where it matters: textures, and inward normals.
#pragma once

#include "common/math/vec.h"

namespace pt {

struct alignas(16) SphereFrame {
  /// The sphere's own axes in the world, of unit length; left-handed where it was mirrored.
  Vec3 x = Vec3(1, 0, 0), y = Vec3(0, 1, 0), z = Vec3(0, 0, 1);
  float side = 1.0f;  ///< -1: its normals point inward

  /// The point at an outward normal in the sphere's own axes.
  PT_HD Vec3 local(const Vec3& normal) const {
    return {dot(normal, x), dot(normal, y), dot(normal, z)};
  }
  PT_HD Vec3 world(const Vec3& v) const { return weighted_sum(v, x, y, z); }
};

/// The distance of a local point from the axis z.
PT_HD float distance_from_axis(const Vec3& local) {
  return square_root(fused_multiply_add(local.x, local.x, multiply_rounded(local.y, local.y)));
}

/// Mitsuba's coordinates: u goes around z from x towards y; v, as ours does, upwards along z.
PT_HD Vec2 sphere_uv(const Vec3& local) {
  const float turns = multiply_rounded(0.5f * inverse_pi, atan2f(local.y, local.x));
  const float from_zenith = atan2f(distance_from_axis(local), local.z);  // exact at the poles
  return {turns < 0.0f ? add_rounded(turns, 1.0f) : turns,
          fused_multiply_add(-inverse_pi, from_zenith, 1.0f)};
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
