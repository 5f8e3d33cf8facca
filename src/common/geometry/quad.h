// Ray-parallelogram intersection.
#pragma once

#include "common/geometry/ray.h"

namespace pt {

/// The parallelogram corner + a edge_a + b edge_b, 0 <= a, b <= 1. The normal is
/// cross(edge_a, edge_b); the dual vectors turn a point of the plane into (a, b) by one dot each.
struct Quad {
  Vec3 corner;
  Vec3 edge_a, edge_b;
  Vec3 dual_a, dual_b;
  Vec3 normal;
  float area;  ///< scene units squared
};

/// `edge_a` and `edge_b` must not be parallel.
PT_HD Quad make_quad(const Vec3& corner, const Vec3& edge_a, const Vec3& edge_b) {
  const Vec3 n = glm::cross(edge_a, edge_b);
  const float n2 = glm::dot(n, n);
  const float area = sqrtf(n2);
  return {corner,   edge_a, edge_b, glm::cross(edge_b, n) / n2, glm::cross(n, edge_a) / n2,
          n / area, area};
}

/// How far beyond its edges a quad is hit: two that share an edge must leave no gap between them.
inline constexpr float quad_margin = 16.0f * half_ulp;

/// Distance along the ray, or a value <= 0 when it misses.
PT_HD float quad_distance(const Quad& quad, const Ray& ray) {
  const float cosine = dot_from_x(quad.normal, ray.direction);
  const Vec3 oc = quad.corner - ray.origin;
  const float t = dot_from_x(quad.normal, oc) / cosine;
  const Vec3 p = add_scaled(-oc, t, ray.direction);
  const float a = dot_from_x(quad.dual_a, p);
  const float b = dot_from_x(quad.dual_b, p);
  constexpr float margin = quad_margin;
  const bool inside = a >= -margin && a <= 1.0f + margin && b >= -margin && b <= 1.0f + margin;
  return inside && t < infinite_distance ? t : -1.0f;
}

PT_HD SurfacePoint quad_surface(const Quad& quad, const Ray& ray, float t) {
  const Vec3 p = add_scaled(ray.origin, t, ray.direction);
  const float distance = dot_from_x(quad.normal, p - quad.corner);
  const Vec3 position = add_scaled(p, -distance, quad.normal);
  const float scale =
      max_abs(position) + max_abs(quad.corner) + max_abs(quad.edge_a) + max_abs(quad.edge_b);
  return {position, quad.normal, 8.0f * half_ulp * scale};
}

}  // namespace pt
