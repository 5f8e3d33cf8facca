// Watertight ray-triangle intersection.
//
// As Woop, Benthin and Wald 2013 ('Watertight Ray/Triangle Intersection', JCGT 2:1): the vertices
// are projected along the ray onto a plane, each by itself and always in the same way, so that
// triangles that share a vertex see the same projected point. The edge functions have the right
// sign, or are zero where that is exact, and zero counts as inside. Two triangles that share an
// edge therefore leave no gap. Where the paper permutes the axes, the projection here is written as
// two vectors of which one component is 0 and one is 1: the same numbers without a selection per
// vertex.
//
// The edge functions are right to 2 half ulps, too, and so the weights of the three vertices. That
// is what makes the distance good for something on needles: see hit_error_distance.
#pragma once

#include "common/geometry/bounds.h"
#include "common/geometry/ray.h"

namespace pt {

/// A triangle as traversal reads it: three 16-byte loads. Elements of the array are called slots;
/// leaves of an acceleration structure are runs of slots, and spatial splits may put a triangle
/// into several.
struct alignas(16) Triangle {
  Vec3 v0;
  std::uint32_t id;  ///< of the triangle, counted through the meshes of the scene
  Vec3 v1;
  std::uint32_t material;
  Vec3 v2;
  std::uint32_t attributes;  ///< see TriangleAttributes
};

/// What else a triangle has, in Triangle::attributes.
struct TriangleAttributes {
  static constexpr std::uint32_t normals = 1;  ///< by vertex: smooth shading
  static constexpr std::uint32_t uvs = 2;      ///< texture coordinates by vertex
  static constexpr std::uint32_t masked = 4;   ///< its material has an opacity below 1
};

PT_HD Bounds triangle_bounds(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {glm::min(glm::min(a, b), c), glm::max(glm::max(a, b), c)};
}

/// How good a hit is. Where intersect_triangle finds one at t > 0, there is a point P of the
/// triangle such that along every axis
///   |origin + t direction - P| <= hit_error_distance |P - origin| + hit_margin.
/// docs/design/tracing.md has the proof; coordinates are within 1e12. Boxes that are wider than the
/// triangle by the margin, and box tests that allow for the first term, therefore never hide a hit:
/// so all acceleration structures find the same.
inline constexpr float hit_error_distance = 18.0f * half_ulp;

/// By axis, for a triangle with these bounds.
PT_HD Vec3 hit_margin(const Bounds& triangle) {
  const Vec3 extent = triangle.max - triangle.min;
  return 4.0f * half_ulp * extent + Vec3(11.0f * half_ulp * max_abs(extent));
}

/// A bound that lies `margin` below, or above, `x` in spite of rounding.
PT_HD float lowered(float x, float margin) { return x - (margin + 2.0f * half_ulp * fabsf(x)); }
PT_HD float raised(float x, float margin) { return x + (margin + 2.0f * half_ulp * fabsf(x)); }

/// The box in which trees keep a triangle.
PT_HD Bounds hit_bounds(const Vec3& a, const Vec3& b, const Vec3& c) {
  Bounds box = triangle_bounds(a, b, c);
  const Vec3 margin = hit_margin(box);
  for (int i = 0; i < 3; ++i) {
    box.min[i] = lowered(box.min[i], margin[i]);
    box.max[i] = raised(box.max[i], margin[i]);
  }
  return box;
}

/// The projection along a ray.
struct TriangleRay {
  Vec3 origin;
  Vec3 x_axis, y_axis;  ///< of the plane of projection
  float inverse;        ///< of the direction's largest component, to measure t,
  std::uint32_t axis;   ///< and which it is
};

/// `direction` is finite and not zero; its length is the unit of t.
PT_HD TriangleRay make_triangle_ray(const Vec3& origin, const Vec3& direction) {
  TriangleRay ray;
  ray.origin = origin;
  const Vec3 size = glm::abs(direction);
  const bool z = size.z >= size.x && size.z >= size.y;
  const bool y = !z && size.y >= size.x;
  const float largest = z ? direction.z : y ? direction.y : direction.x;
  const float inverse = 1.0f / largest;
  ray.inverse = inverse;
  ray.axis = z ? 2 : y ? 1 : 0;
  if (z) {
    ray.x_axis = {1, 0, -direction.x * inverse};
    ray.y_axis = {0, 1, -direction.y * inverse};
  } else if (y) {
    ray.x_axis = {0, -direction.z * inverse, 1};
    ray.y_axis = {1, -direction.x * inverse, 0};
  } else {
    ray.x_axis = {-direction.y * inverse, 1, 0};
    ray.y_axis = {-direction.z * inverse, 0, 1};
  }
  return ray;
}

/// The hit of a ray and a triangle: barycentric coordinates b0 + b1 + b2 = 1.
struct TriangleHit {
  float t;  ///< NaN: none
  float b1, b2;

  PT_HD bool is_hit() const { return t == t; }
};

/// The hit at any t, also behind the origin; none for a triangle without area as the ray sees it.
PT_HD TriangleHit intersect_triangle(const TriangleRay& ray, const Vec3& v0, const Vec3& v1,
                                     const Vec3& v2) {
  const Vec3 a = v0 - ray.origin, b = v1 - ray.origin, c = v2 - ray.origin;
  const auto project = [](const Vec3& axis, const Vec3& v) {
    return fused_multiply_add(axis.x, v.x, fused_multiply_add(axis.y, v.y, axis.z * v.z));
  };
  const float ax = project(ray.x_axis, a), ay = project(ray.y_axis, a);
  const float bx = project(ray.x_axis, b), by = project(ray.y_axis, b);
  const float cx = project(ray.x_axis, c), cy = project(ray.y_axis, c);
  const float u = difference_of_products(cx, by, cy, bx);
  const float v = difference_of_products(ax, cy, ay, cx);
  const float w = difference_of_products(bx, ay, by, ax);
  const float determinant = u + v + w;
  const bool miss = differ_in_sign(u, v, w);
  const float inverse = approximate_inverse(determinant);
  const auto depth = [&ray](const Vec3& p) {
    return ray.axis == 2 ? p.z : ray.axis == 1 ? p.y : p.x;
  };
  // Without area all three are 0, and t is NaN.
  const float sum = sum_of_products(u, depth(a), v, depth(b), w, depth(c));
  const float t = sum * inverse * ray.inverse;
  return {miss ? bits_to_float(0x7fffffffu) : t, v * inverse, w * inverse};
}

}  // namespace pt
