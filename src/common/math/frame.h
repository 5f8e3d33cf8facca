// An orthonormal frame around a normal.
#pragma once

#include "common/math/vec.h"

namespace pt {

struct Frame {
  Vec3 tangent, bitangent, normal;

  PT_HD Vec3 to_world(const Vec3& local) const {
    return weighted_sum(local, tangent, bitangent, normal);
  }
};

/// Branch-free and continuous but for the z = 0 crossing; `n` has unit length.
/// Duff et al. 2017, 'Building an Orthonormal Basis, Revisited', JCGT 6(1).
PT_HD Frame make_frame(const Vec3& n) {
  const float sign = copysignf(1.0f, n.z);
  const float a = -1.0f / (sign + n.z);
  const float b = n.x * n.y * a;
  return {{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

}  // namespace pt
