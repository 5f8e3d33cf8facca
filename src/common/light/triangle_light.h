// Sampling a triangle that emits, on the side to which cross(v1 - v0, v2 - v0) points.
#pragma once

#include "common/light/area_light.h"

namespace pt {

/// A point of a triangle: b0 v0 + b1 v1 + b2 v2 with b0 = 1 - b1 - b2.
struct TrianglePoint {
  float b1, b2;
};

/// Uniform over the area of any triangle, without a square root and with less distortion than one
/// (Heitz 2019, 'A Low-Distortion Map Between Triangle and Square').
PT_HD TrianglePoint sample_triangle_point(float u0, float u1) {
  return u1 > u0 ? TrianglePoint{0.5f * u0, u1 - 0.5f * u0}
                 : TrianglePoint{u0 - 0.5f * u1, 0.5f * u1};
}

/// Density per solid angle of sample_triangle at a point of the triangle `distance` away along
/// `wi`; 0 from behind. `normal` is cross(v1 - v0, v2 - v0), whose length is twice the area.
PT_HD float triangle_solid_angle_pdf(const Vec3& normal, const Vec3& wi, float distance) {
  const float cosine_times_area = -0.5f * dot(normal, wi);
  return cosine_times_area > 0.0f ? distance * distance / cosine_times_area : 0.0f;
}

struct TriangleLightSample {
  LightSample light;
  TrianglePoint point = {0.0f, 0.0f};  ///< where, for a textured emission
};

/// Uniform over the area of the triangle v0, v0 + edge1, v0 + edge2, on the side to which
/// cross(edge1, edge2) points.
PT_HD TriangleLightSample sample_triangle(const Vec3& v0, const Vec3& edge1, const Vec3& edge2,
                                          const LightError& error, const Vec3& from, float u0,
                                          float u1) {
  const TrianglePoint point = sample_triangle_point(u0, u1);
  // Relative to `from` before the sum: the nearer the light, the smaller the rounding error.
  const Vec3 to_light = add_scaled(add_scaled(v0 - from, point.b1, edge1), point.b2, edge2);
  const float distance2 = dot(to_light, to_light);
  if (distance2 == 0.0f) return {};
  const float inverse_distance = inverse_sqrt(distance2), distance = distance2 * inverse_distance;
  const Vec3 wi = inverse_distance * to_light;
  const Vec3 normal = cross_rounded(edge1, edge2);
  const float inverse_length = inverse_sqrt(fmaxf(dot(normal, normal), 1e-37f));
  const Vec3 end = add_scaled(to_light, error.bound(distance) * inverse_length, normal);
  return {{wi, triangle_solid_angle_pdf(normal, wi, distance), end}, point};
}

}  // namespace pt
