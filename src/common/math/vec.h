// Vectors: GLM under the names of this project.
#pragma once

#include "common/platform/platform.h"  // before GLM

// Without the other names of the components (r, s, ...), which are members of unions: nvcc 13.0
// reports an invalid bitcast for some constructors of classes that hold such vectors.
#define GLM_FORCE_XYZW_ONLY
#include <glm/glm.hpp>

namespace pt {

using Vec2 = glm::vec2;
using Vec3 = glm::vec3;
using Vec4 = glm::vec4;
using Color = glm::vec3;  ///< linear RGB radiance or reflectance

inline constexpr float pi = 3.14159265358979f;
inline constexpr float inverse_pi = 0.31830988618379f;
inline constexpr float half_ulp = 5.9604645e-8f;     ///< 2^-24: rounding error of one operation
inline constexpr float one_minus_ulp = 0.99999994f;  ///< the largest float below 1

// Sums of products, fused on CUDA.

PT_HD float dot(const Vec3& a, const Vec3& b) {
  return fused_multiply_add(a.x, b.x, fused_multiply_add(a.y, b.y, a.z * b.z));
}

/// In the order of glm::dot, in which the CPU's lanes test spheres and quads.
PT_HD float dot_from_x(const Vec3& a, const Vec3& b) {
  return fused_multiply_add(a.z, b.z, fused_multiply_add(a.y, b.y, a.x * b.x));
}

/// a + t b.
PT_HD Vec3 add_scaled(const Vec3& a, float t, const Vec3& b) {
  return {fused_multiply_add(t, b.x, a.x), fused_multiply_add(t, b.y, a.y),
          fused_multiply_add(t, b.z, a.z)};
}

/// w.x a + w.y b + w.z c.
PT_HD Vec3 weighted_sum(const Vec3& w, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto sum = [&w](float p, float q, float r) {
    return fused_multiply_add(w.x, p, fused_multiply_add(w.y, q, w.z * r));
  };
  return {sum(a.x, b.x, c.x), sum(a.y, b.y, c.y), sum(a.z, b.z, c.z)};
}

/// v / |v|.
PT_HD Vec3 normalize(const Vec3& v) {
  const float scale = inverse_sqrt(dot(v, v));
  return {v.x * scale, v.y * scale, v.z * scale};
}

PT_HD Vec3 optimization_barrier(const Vec3& v) {
  return {optimization_barrier(v.x), optimization_barrier(v.y), optimization_barrier(v.z)};
}

PT_HD Color divide(const Color& a, float b) {
  return {divide(a.x, b), divide(a.y, b), divide(a.z, b)};
}

/// a + t (b - a).
PT_HD float interpolate(float a, float b, float t) { return fused_multiply_add(t, b - a, a); }
PT_HD Color interpolate(const Color& a, const Color& b, float t) {
  return {interpolate(a.x, b.x, t), interpolate(a.y, b.y, t), interpolate(a.z, b.z, t)};
}

/// The mean of the three channels.
PT_HD float mean(const Color& c) { return (c.x + c.y + c.z) * (1.0f / 3.0f); }

PT_HD bool is_black(const Color& c) { return c.x == 0.0f && c.y == 0.0f && c.z == 0.0f; }

/// Largest absolute component: the scale of a position's rounding error.
PT_HD float max_abs(const Vec3& v) { return fmaxf(fmaxf(fabsf(v.x), fabsf(v.y)), fabsf(v.z)); }

}  // namespace pt
