// Equiangular sampling: distances along a ray as a light at a point lights them (Kulla and Fajardo
// 2012, 'Importance sampling techniques for path tracing in participating media', section 4.1).
#pragma once

#include "common/geometry/ray.h"

namespace pt {

/// Of the part [0, t_max] of a ray, as seen from a point; t_max may be infinite_distance.
class Equiangular {
 public:
  PT_HD Equiangular(const Ray& ray, float t_max, const Vec3& point) {
    const Vec3 to_point = point - ray.origin;
    nearest_ = dot(to_point, ray.direction);
    const Vec3 across = add_scaled(to_point, -nearest_, ray.direction);
    // A point on the ray would get all samples.
    distance_ = fmaxf(fast_sqrt(dot(across, across)), 1e-4f * fmaxf(max_abs(to_point), 1e-20f));
    begin_ = atan2f(-nearest_, distance_);
    angle_ = atan2f(t_max - nearest_, distance_) - begin_;
  }

  /// Whether the point sees the part under more than a right angle: else distances hardly matter,
  /// and the extinction samples them better (results/log/2026-11-media.md).
  PT_HD bool pays() const { return angle_ > 1.57f; }

  /// u uniform in [0, 1).
  PT_HD float sample(float u) const {
    const float angle = fused_multiply_add(u, angle_, begin_);
    return fmaxf(fused_multiply_add(distance_, tanf(angle), nearest_), 0.0f);
  }

  /// Density of a distance t.
  PT_HD float pdf(float t) const {
    const float from_nearest = t - nearest_;
    const float square =
        fused_multiply_add(distance_, distance_, multiply_rounded(from_nearest, from_nearest));
    return divide(distance_, multiply_rounded(angle_, square));
  }

 private:
  float nearest_, distance_, begin_, angle_;
};

}  // namespace pt
