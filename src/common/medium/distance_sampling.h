// Sampling distances in media: by the channels' extinctions, and towards a light.
#pragma once

#include "common/geometry/ray.h"

namespace pt {

/// Spectral multiple importance sampling. A distance can be sampled by the extinction of one
/// channel alone, and in a coloured medium each channel prefers other paths. So a path is sampled
/// by a channel chosen at random, and weighted by the mean density with which the three would have
/// sampled all of it (the balance heuristic; Miller et al. 2019, 'A null-scattering path integral
/// formulation of light transport', section 5; pbrt-v4, section 14.1.4). The channel need not be
/// remembered: choosing it again for each event, with the probability that the path so far was
/// sampled by it, gives the same paths.
///
/// The members are the densities with which the channels sample the path so far, over their mean.
struct ChannelDensities {
  float red = 1.0f, green = 1.0f;  ///< blue: 3 - red - green

  PT_HD Color all() const { return {red, green, fmaxf(3.0f - red - green, 0.0f)}; }

  /// The channel for the next event; `u` is uniform in [0, 1).
  PT_HD int choose(float u) const {
    const float at = 3.0f * u;
    return at < red ? 0 : at < red + green ? 1 : 2;
  }

  /// Adds an event that the channels sample with these densities. Returns its weight: `value` over
  /// the mean density.
  PT_HD Color weigh(const Color& value, const Color& densities) {
    const Color weighted = all() * densities;
    const float sum = mean(weighted);
    if (!(sum > 0.0f)) return Color(0.0f);
    const Color inverse(divide(1.0f, sum));
    red = weighted.x * inverse.x, green = weighted.y * inverse.x;
    return value * inverse;
  }
};

PT_HD float channel(const Color& color, int index) {
  return index == 0 ? color.x : index == 1 ? color.y : color.z;
}

PT_HD bool is_grey(const Color& color) { return color.x == color.y && color.y == color.z; }

/// Equiangular sampling of distances along a ray, uniform in the angle at a point light (Kulla and
/// Fajardo 2012, 'Importance sampling techniques for path tracing in participating media', section
/// 4.1). For the part [0, t_max] of the ray; t_max may be infinite_distance.
class Equiangular {
 public:
  PT_HD Equiangular(const Ray& ray, float t_max, const Vec3& point) {
    const Vec3 to_point = point - ray.origin;
    nearest_ = dot(to_point, ray.direction);
    const Vec3 across = add_scaled(to_point, -nearest_, ray.direction);
    // Not 0: else a point on the ray would get all samples.
    distance_ = fmaxf(fast_sqrt(dot(across, across)), 1e-4f * fmaxf(max_abs(to_point), 1e-20f));
    begin_ = atan2f(-nearest_, distance_);
    angle_ = atan2f(t_max - nearest_, distance_) - begin_;
  }

  /// Whether the angle at the point is more than a right angle. Else distances hardly matter, and
  /// sampling by the extinction is better (results/log/2026-11-media.md).
  PT_HD bool pays() const { return angle_ > 1.57f; }

  /// u uniform in [0, 1).
  PT_HD float sample(float u) const {
    const float angle = fused_multiply_add(u, angle_, begin_);
    return fmaxf(fused_multiply_add(distance_, tanf(angle), nearest_), 0.0f);
  }

  /// Density of a distance t.
  PT_HD float pdf(float t) const {
    const float from_nearest = t - nearest_;
    const float square = fused_multiply_add(distance_, distance_, from_nearest * from_nearest);
    return divide(distance_, angle_ * square);
  }

 private:
  float nearest_, distance_, begin_, angle_;
};

}  // namespace pt
