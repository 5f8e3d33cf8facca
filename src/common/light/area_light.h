// Spheres and quads that emit (pbrt-v4, sections 6.2.4 and 12.4).
#pragma once

#include <cmath>

#include "common/geometry/primitives.h"
#include "common/light/light.h"
#include "common/light/light_sample.h"
#include "common/math/transform.h"
#include "common/sampling/warp.h"

namespace pt {

/// Density per solid angle of sample_quad at a point of the quad `distance` away along `wi`.
PT_HD float quad_solid_angle_pdf(const Quad& quad, const Vec3& wi, float distance) {
  const float cosine = -dot(quad.normal, wi);
  return cosine > 0.0f ? distance * distance / (cosine * quad.area) : 0.0f;
}

/// Uniform over the area, on the side to which the normal points.
PT_HD LightSample sample_quad(const Quad& quad, const Vec3& from, float u0, float u1) {
  // Relative to `from` before the sum: the nearer the light, the smaller the rounding error.
  const Vec3 to_light =
      add_scaled(add_scaled(quad.corner - from, u0, quad.edge_a), u1, quad.edge_b);
  const float distance2 = dot(to_light, to_light);
  if (distance2 == 0.0f) return {};
  const float inverse_distance = inverse_sqrt(distance2), distance = distance2 * inverse_distance;
  const Vec3 wi = inverse_distance * to_light;
  const float size = max_abs(quad.edge_a) + max_abs(quad.edge_b);
  return {wi, quad_solid_angle_pdf(quad, wi, distance),
          add_scaled(to_light, light_rounding * (distance + size), quad.normal)};
}

PT_HD float sphere_area(const Sphere& sphere) { return 4.0f * pi * sphere.radius_squared; }

/// 1 - cos of the half angle under which the sphere is seen from `from`, outside of it, without
/// cancellation for small ones; 0 from inside.
PT_HD float sphere_one_minus_cos(const Sphere& sphere, const Vec3& from) {
  const Vec3 to_center = sphere.center - from;
  const float distance2 = dot(to_center, to_center);
  if (distance2 <= sphere.radius_squared) return 0.0f;
  const float sin2 = sphere.radius_squared / distance2;
  return sin2 / (1.0f + sqrtf(1.0f - sin2));
}

PT_HD float sphere_solid_angle_pdf(const Sphere& sphere, const Vec3& from) {
  const float one_minus_cos = sphere_one_minus_cos(sphere, from);
  return one_minus_cos > 0.0f ? 0.5f * inverse_pi / one_minus_cos : 0.0f;
}

/// Uniform over the cone of directions in which the sphere is seen; none from inside.
PT_HD LightSample sample_sphere(const Sphere& sphere, const Vec3& from, float u0, float u1) {
  const float one_minus_cos_max = sphere_one_minus_cos(sphere, from);
  if (one_minus_cos_max <= 0.0f) return {};
  const float one_minus_cos = u0 * one_minus_cos_max;
  const float cos_theta = 1.0f - one_minus_cos;
  const float sin_theta = sqrtf(fmaxf(0.0f, one_minus_cos * (2.0f - one_minus_cos)));
  const SinCos phi = sincos_2pi(u1);
  const Vec3 to_center = sphere.center - from;
  const Frame frame = make_frame(normalize(to_center));
  const Vec3 wi = normalize(frame.to_world({sin_theta * phi.cos, sin_theta * phi.sin, cos_theta}));
  float distance = sphere_distance(sphere, {from, wi});
  if (distance <= 0.0f) {  // grazing: rounding has moved the ray past the sphere
    distance = dot(to_center, wi);
  }
  const Vec3 normal = normalize(add_scaled(-to_center, distance, wi));
  const float radius = sphere.radius();
  const float end_radius = fused_multiply_add(light_rounding, distance + radius, radius);
  return {wi, 0.5f * inverse_pi / one_minus_cos_max, add_scaled(to_center, end_radius, normal)};
}

PT_HD LightSample sample_primitive(const Primitives& primitives, std::uint32_t primitive,
                                   const Vec3& from, float u0, float u1) {
  return primitives.is_sphere(primitive)
             ? sample_sphere(primitives.spheres[primitive], from, u0, u1)
             : sample_quad(primitives.quad(primitive), from, u0, u1);
}

/// Density with which sample_primitive at `from` would have chosen the point that a ray from there
/// hit at `distance` in direction `wi`.
PT_HD float primitive_pdf(const Primitives& primitives, std::uint32_t primitive, const Vec3& from,
                          const Vec3& wi, float distance) {
  return primitives.is_sphere(primitive)
             ? sphere_solid_angle_pdf(primitives.spheres[primitive], from)
             : quad_solid_angle_pdf(primitives.quad(primitive), wi, distance);
}

/// A sphere in scenes that list their lights.
struct alignas(16) SphereLight {
  static constexpr LightKind type = LightKind::sphere;
  static constexpr bool has_position = true;

  Vec3 center{0.0f};
  LightKind kind = type;
  float unused_a[3] = {};
  float weight = 0.0f;
  float radius_squared = 0.0f;
  float unused_b[3] = {};
  Color radiance{0.0f};
  std::uint32_t emission_texture = no_texture;

  PT_HD PlainLight sample(const Vec3& from, float u0, float u1) const {
    const LightSample s = sample_sphere({center, radius_squared}, from, u0, u1);
    return {{s.wi, s.end, radiance, s.pdf}};
  }
  LightBounds bounds() const {
    LightBounds bounds;
    const Vec3 radius(std::sqrt(radius_squared));
    bounds.box.grow(center - radius), bounds.box.grow(center + radius);
    bounds.cone = half_turn;
    bounds.emission = quarter_turn;
    bounds.intensity = 0.25f * weight;
    return bounds;
  }
};

}  // namespace pt
