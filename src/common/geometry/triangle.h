// Watertight ray-triangle intersection.
//
// As Woop, Benthin and Wald 2013 ('Watertight Ray/Triangle Intersection', JCGT 2:1): the vertices
// are projected along the ray onto a plane, each by itself and always in the same way, so that
// triangles that share a vertex see the same projected point. The edge functions are differences of
// two rounded products: rounding is monotone, so their sign is right or they are zero, and zero
// counts as inside. Two triangles that share an edge therefore leave no gap. Where the paper
// permutes the axes, the projection here is written as two vectors of which one component is 0 and
// one is 1: the same numbers without a selection per vertex.
#pragma once

#include "common/geometry/bounds.h"
#include "common/geometry/ray.h"

namespace pt {

/// A triangle as traversal reads it: three 16-byte loads. Places in the array are called slots;
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
};

PT_HD Bounds triangle_bounds(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {glm::min(glm::min(a, b), c), glm::max(glm::max(a, b), c)};
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

/// Where a ray meets a triangle's plane inside of it: barycentric coordinates b0 + b1 + b2 = 1.
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
    return fused_multiply_add(axis.x, v.x,
                              fused_multiply_add(axis.y, v.y, multiply_rounded(axis.z, v.z)));
  };
  const float ax = project(ray.x_axis, a), ay = project(ray.y_axis, a);
  const float bx = project(ray.x_axis, b), by = project(ray.y_axis, b);
  const float cx = project(ray.x_axis, c), cy = project(ray.y_axis, c);
  const auto edge = [](float px, float py, float qx, float qy) {
    return add_rounded(multiply_rounded(px, qy), -multiply_rounded(py, qx));
  };
  const float u = edge(cx, cy, bx, by);
  const float v = edge(ax, ay, cx, cy);
  const float w = edge(bx, by, ax, ay);
  const float least = fminf(fminf(u, v), w);
  const float most = fmaxf(fmaxf(u, v), w);
  const float determinant = add_rounded(add_rounded(u, v), w);
  const bool miss = (least < 0.0f && most > 0.0f) || determinant == 0.0f;
  const float inverse = approximate_inverse(determinant);
  const auto depth = [&ray](const Vec3& p) {
    const float component = ray.axis == 2 ? p.z : ray.axis == 1 ? p.y : p.x;
    return multiply_rounded(component, ray.inverse);
  };
  const float az = depth(a), bz = depth(b), cz = depth(c);
  const float sum = fused_multiply_add(u, az, fused_multiply_add(v, bz, multiply_rounded(w, cz)));
  return {miss ? bits_to_float(0x7fffffffu) : multiply_rounded(sum, inverse),
          multiply_rounded(v, inverse), multiply_rounded(w, inverse)};
}

}  // namespace pt
