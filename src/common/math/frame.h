// An orthonormal frame around a normal.
#pragma once

#include "common/math/vec.h"

namespace pt {

struct Frame {
  Vec3 tangent, bitangent, normal;

  PT_HD Vec3 to_world(const Vec3& local) const {
    return weighted_sum(local, tangent, bitangent, normal);
  }
  PT_HD Vec3 to_local(const Vec3& world) const {
    return {dot(world, tangent), dot(world, bitangent), dot(world, normal)};
  }
};

/// Branch-free and continuous but for the z = 0 crossing; `n` has unit length.
/// Duff et al. 2017, 'Building an Orthonormal Basis, Revisited', JCGT 6(1).
PT_HD Frame make_frame(const Vec3& n) {
  const float sign = copysignf(1.0f, n.z);
  const float a = -approximate_inverse(sign + n.z);
  const float b = multiply_rounded(n.x * n.y, a);
  return {{fused_multiply_add(sign * n.x * n.x, a, 1.0f), sign * b, -sign * n.x},
          {b, fused_multiply_add(n.y * n.y, a, sign), -n.y},
          n};
}

/// The frame whose tangent is the part of `dp_du` across the normal; any, where there is none.
PT_HD Frame make_frame(const Vec3& n, const Vec3& dp_du) {
  const Vec3 across = add_scaled(dp_du, -dot(n, dp_du), n);
  const float length2 = dot(across, across);
  if (!(length2 > 1e-12f * dot(dp_du, dp_du))) return make_frame(n);
  const Vec3 tangent = normalize(across);
  return {tangent, cross_rounded(n, tangent), n};
}

}  // namespace pt
