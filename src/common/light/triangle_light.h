// Sampling triangles that emit, uniformly over their area.
#pragma once

#include "common/light/area_light.h"

namespace pt {

struct TriangleLightSample {
  Vec3 wi = Vec3(0.0f);
  float distance = 0.0f;  ///< to the sampled point, less the rounding error
  float pdf = 0.0f;       ///< per solid angle; 0: nothing to be gained
  Vec3 barycentric = Vec3(0.0f);
};

PT_HD float triangle_area(const Vec3& v0, const Vec3& v1, const Vec3& v2) {
  return 0.5f * glm::length(glm::cross(v1 - v0, v2 - v0));
}

/// Density per solid angle of sample_triangle at a point of the triangle `distance` away along `wi`.
PT_HD float triangle_solid_angle_pdf(const Vec3& v0, const Vec3& v1, const Vec3& v2,
                                     const Vec3& wi, float distance) {
  const float twice_projected = fabsf(glm::dot(glm::cross(v1 - v0, v2 - v0), wi));
  return twice_projected > 0.0f ? 2.0f * distance * distance / twice_projected : 0.0f;
}

/// A point of the triangle from two uniform numbers, with less distortion than the square root's
/// (Heitz 2019, 'A Low-Distortion Map Between Triangle and Square').
PT_HD Vec3 sample_barycentric(float u0, float u1) {
  const bool upper = u1 > u0;
  const float b0 = upper ? 0.5f * u0 : u0 - 0.5f * u1;
  const float b1 = upper ? u1 - 0.5f * u0 : 0.5f * u1;
  return {b0, b1, 1.0f - b0 - b1};
}

/// On the side to which cross(v1 - v0, v2 - v0) points.
PT_HD TriangleLightSample sample_triangle(const Vec3& v0, const Vec3& v1, const Vec3& v2,
                                          const Vec3& from, float u0, float u1) {
  const Vec3 b = sample_barycentric(u0, u1);
  const Vec3 to_light = b.x * v0 + b.y * v1 + b.z * v2 - from;
  const float distance2 = glm::dot(to_light, to_light);
  if (distance2 == 0.0f) return {};
  const float distance = sqrtf(distance2);
  const Vec3 wi = to_light / distance;
  if (glm::dot(glm::cross(v1 - v0, v2 - v0), wi) >= 0.0f) return {};
  return {wi, distance * (1.0f - 1e-4f), triangle_solid_angle_pdf(v0, v1, v2, wi, distance), b};
}

}  // namespace pt
