// Sampling a triangle that emits, on the side to which cross(v1 - v0, v2 - v0) points.
#pragma once

#include "common/light/area_light.h"
#include "common/light/light_bounds.h"
#include "common/light/spherical_triangle.h"

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

/// How a triangle is sampled: by area or, where it covers much of the view, by solid angle
/// (pbrt-v4, section 6.5.4). The choice depends on the triangle and the reference point alone, so
/// that pdf() can repeat it.
struct TriangleSampler {
  Vec3 v0;  ///< relative to the reference point, in world space
  Vec3 edge1, edge2;
  Vec3 normal;  ///< cross(edge1, edge2), whose length is twice the area

  PT_HD TriangleSampler(const Vec3& relative_v0, const Vec3& e1, const Vec3& e2)
      : v0(relative_v0), edge1(e1), edge2(e2), normal(cross_rounded(e1, e2)) {}

  /// Whether area / distance^2 is above 1/10: below, the density per area differs little from it.
  PT_HD bool uses_solid_angle_sampling() const {
    const Vec3 middle = add_scaled(v0, 1.0f / 3.0f, edge1 + edge2);
    const float distance2 = dot(middle, middle);
    return dot(normal, normal) > 0.04f * distance2 * distance2;
  }

  PT_HD SphericalTriangle seen() const { return {v0, v0 + edge1, v0 + edge2, normal}; }

  /// False for smaller ones, of a triangle seen edge-on, in which directions are rounded too much,
  /// and where the reference point is a corner.
  static PT_HD bool has_solid_angle(const SphericalTriangle& seen) {
    return seen.solid_angle > 1e-3f;
  }

  /// Density per solid angle at a point `distance` away along `wi`, from either side.
  PT_HD float pdf(const Vec3& wi, float distance) const {
    if (uses_solid_angle_sampling()) {
      const SphericalTriangle s = seen();
      if (has_solid_angle(s)) return divide(1.0f, s.solid_angle);
    }
    const float cosine_times_area = 0.5f * fabsf(dot(normal, wi));
    return cosine_times_area > 0.0f ? divide(distance * distance, cosine_times_area) : 0.0f;
  }

  /// Where a ray along `wi` meets its plane, within the triangle but for rounding.
  PT_HD TrianglePoint point_along(const Vec3& wi) const {
    const Vec3 p = add_scaled(-v0, divide(dot(v0, normal), dot(wi, normal)), wi);
    const float scale = divide(1.0f, dot(normal, normal));
    const auto share = [&](const Vec3& across) {
      return fminf(fmaxf(dot(across, normal) * scale, 0.0f), 1.0f);
    };
    const float b1 = share(cross_rounded(p, edge2));
    return {b1, fminf(share(cross_rounded(edge1, p)), 1.0f - b1)};
  }

  PT_HD TrianglePoint sample(float u0, float u1) const {
    if (uses_solid_angle_sampling()) {
      const SphericalTriangle s = seen();
      if (has_solid_angle(s)) return point_along(s.sample(u0, u1));
    }
    return sample_triangle_point(u0, u1);
  }
};

struct TriangleLightSample {
  LightSample light;
  TrianglePoint point = {0.0f, 0.0f};  ///< where, for a textured emission
};

/// A point of the triangle v0, v0 + edge1, v0 + edge2, which emits on the side to which
/// cross(edge1, edge2) points; density 0 from behind.
PT_HD TriangleLightSample sample_triangle(const Vec3& v0, const Vec3& edge1, const Vec3& edge2,
                                          const LightError& error, const Vec3& from, float u0,
                                          float u1) {
  // Relative to `from` before the sum: the nearer the light, the smaller the rounding error.
  const TriangleSampler sampler(v0 - from, edge1, edge2);
  if (dot(sampler.v0, sampler.normal) >= 0.0f) return {};
  const TrianglePoint point = sampler.sample(u0, u1);
  const Vec3 to_light = add_scaled(add_scaled(sampler.v0, point.b1, edge1), point.b2, edge2);
  const float distance2 = dot(to_light, to_light);
  if (distance2 == 0.0f) return {};
  const float inverse_distance = inverse_sqrt(distance2), distance = distance2 * inverse_distance;
  const Vec3 wi = inverse_distance * to_light;
  if (dot(sampler.normal, wi) >= 0.0f) return {};
  const float inverse_length = inverse_sqrt(fmaxf(dot(sampler.normal, sampler.normal), 1e-37f));
  const Vec3 end = add_scaled(to_light, error.bound(distance) * inverse_length, sampler.normal);
  return {{wi, sampler.pdf(wi, distance), end}, point};
}

/// sample_triangle_light (transport/sample_light.h) samples it.
struct TriangleLight {
  static constexpr LightKind kind = LightKind::triangle;
  static constexpr bool has_position = true;

  static LightBounds bounds(const Light& light) {
    LightBounds bounds;
    for (const Vec3& corner : {light.a, light.a + light.b, light.a + light.c}) {
      bounds.box.grow(corner);
    }
    const Vec3 n = glm::cross(light.b, light.c);
    if (!(glm::length(n) > 0.0f)) return bounds;
    bounds.axis = glm::normalize(n);
    bounds.emission = quarter_turn;
    bounds.intensity = light.weight;
    return bounds;
  }
};

struct MirroredTriangleLight : TriangleLight {
  static constexpr LightKind kind = LightKind::flipped_triangle;
};

}  // namespace pt
