// From uniform numbers to directions: warps with known densities (pbrt-v4, appendix A.5).
#pragma once

#include "common/math/functions.h"
#include "common/math/vec.h"

namespace pt {

/// A uniform float in [0, 1) from 32 random bits, of which it keeps 24.
PT_HD float to_unit_float(std::uint32_t bits) {
  return static_cast<float>(bits >> 8) * 5.9604645e-8f;
}

/// Uniform on the unit sphere; density 1 / (4 pi).
PT_HD Vec3 sample_unit_sphere(float u0, float u1) {
  const float z = fused_multiply_add(-2.0f, u0, 1.0f);
  const float r = fast_sqrt(fused_multiply_add(-z, z, 1.0f));
  const SinCos phi = sincos_2pi(u1);
  return {r * phi.cos, r * phi.sin, z};
}

/// Densities of sample_unit_sphere, and of its half, per solid angle.
inline constexpr float unit_sphere_pdf = 0.25f * inverse_pi,
                       unit_hemisphere_pdf = 0.5f * inverse_pi;

/// Uniform in the unit ball; density 3 / (4 pi) per volume.
PT_HD Vec3 sample_unit_ball(float u0, float u1, float u2) {
  const float radius = exp2f(log2f(fmaxf(u2, 1e-30f)) * (1.0f / 3.0f));
  return radius * sample_unit_sphere(u0, u1);
}

struct Disk {
  float x, y;
};

/// Uniform on the unit disk; density 1 / pi.
PT_HD Disk sample_unit_disk(float u0, float u1) {
  const float r = fast_sqrt(u0);
  const SinCos phi = sincos_2pi(u1);
  return {r * phi.cos, r * phi.sin};
}

/// Cosine-distributed about the z axis; density cosine_hemisphere_pdf(z). z is not 0 (Malley;
/// pbrt-v4, section A.5.3).
PT_HD Vec3 sample_cosine_hemisphere(float u0, float u1) {
  const Disk disk = sample_unit_disk(u0, u1);
  return {disk.x, disk.y, fast_sqrt(1.0f - u0)};
}

PT_HD float cosine_hemisphere_pdf(float cosine) { return cosine * inverse_pi; }

/// Cosine-distributed around the unit vector `n`; density cos(theta) / pi. The sum of the normal
/// and a uniform point on the sphere has exactly this direction, and needs no frame.
PT_HD Vec3 sample_cosine_hemisphere(const Vec3& n, float u0, float u1) {
  const Vec3 sum = n + sample_unit_sphere(u0, u1);
  // The sum vanishes when the point is -n: any direction will do, once in 2^24 samples.
  return dot(sum, sum) > 1e-12f ? normalize(sum) : n;
}

}  // namespace pt
