// A triangle that emits, on the side to which cross(v1 - v0, v2 - v0) points.
#pragma once

#include "common/light/light.h"
#include "common/math/functions.h"
#include "common/math/vec.h"

namespace pt {

/// A triangle seen from the origin, sampled uniformly by solid angle (Arvo 1995, 'Stratified
/// Sampling of Spherical Triangles'), with the half-angle form of Peters (2021, 'BRDF Importance
/// Sampling for Polygonal Lights'), which needs one arc function only.
struct SphericalTriangle {
  Vec3 a, b, c;       ///< unit vectors to its corners
  float volume;       ///< |det(a, b, c)|
  float solid_angle;  ///< of either side

  /// v: relative to the point that sees it, none of them at it. `normal` = cross(v1 - v0, v2 - v0):
  /// of the difference, so that small triangles lose no digits.
  PT_HD SphericalTriangle(const Vec3& v0, const Vec3& v1, const Vec3& v2, const Vec3& normal) {
    const float la = inverse_sqrt(dot(v0, v0)), lb = inverse_sqrt(dot(v1, v1)),
                lc = inverse_sqrt(dot(v2, v2));
    a = la * v0, b = lb * v1, c = lc * v2;
    volume = fabsf(dot(v0, normal)) * la * lb * lc;
    // Van Oosterom and Strackee (1983).
    solid_angle = 2.0f * atan2f(volume, 1.0f + dot(a, b) + (dot(b, c) + dot(c, a)));
  }

  /// A unit vector into it, uniform in solid angle.
  PT_HD Vec3 sample(float u0, float u1) const {
    // The corner c moves towards a until the rest, between a, b and it, has the share u0.
    const SinCos half = sincos_2pi(0.25f * inverse_pi * u0 * solid_angle);
    const float to_a = fused_multiply_add(volume, half.cos, -((dot(b, c) + dot(c, a)) * half.sin));
    const float to_c = (1.0f + dot(a, b)) * half.sin;
    const Vec3 middle = add_scaled(to_a * a, to_c, c);
    const float turn = divide(2.0f * dot(a, middle), fmaxf(dot(middle, middle), 1e-30f));
    const Vec3 moved = add_scaled(-a, turn, middle);
    // On the arc from b to it, uniform in the cosine of the angle to b.
    const Vec3 apart = moved - b;
    const float h = 0.5f * u1 * dot(apart, apart);  // 1 - cos
    const Vec3 across = add_scaled(moved, -dot(moved, b), b);
    const float sine = square_root(fmaxf(0.0f, h * (2.0f - h)));
    const float scale = sine * inverse_sqrt(fmaxf(dot(across, across), 1e-30f));
    return normalize(add_scaled(add_scaled(b, -h, b), scale, across));
  }
};

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

/// How a triangle is sampled: by area or, where its solid angle is large, by solid angle
/// (pbrt-v4, section 6.5.4). The choice depends on the triangle and the reference point alone, so
/// that pdf() can repeat it.
struct TriangleSampler {
  Vec3 v0;  ///< relative to the reference point, in world space
  Vec3 edge1, edge2;
  Vec3 normal;  ///< cross(edge1, edge2), whose length is twice the area

  PT_HD TriangleSampler(const Vec3& relative_v0, const Vec3& e1, const Vec3& e2)
      : v0(relative_v0), edge1(e1), edge2(e2), normal(glm::cross(e1, e2)) {}

  /// Whether area / distance^2 is above 1/10: below, the density per area differs little from it.
  PT_HD bool uses_solid_angle_sampling() const {
    const Vec3 middle = add_scaled(v0, 1.0f / 3.0f, edge1 + edge2);
    const float distance2 = dot(middle, middle);
    return dot(normal, normal) > 0.04f * distance2 * distance2;
  }

  PT_HD SphericalTriangle spherical() const { return {v0, v0 + edge1, v0 + edge2, normal}; }

  /// False if the reference point is a corner, and for small solid angles (triangles seen edge-on),
  /// in which directions are rounded too much.
  static PT_HD bool has_solid_angle(const SphericalTriangle& triangle) {
    return triangle.solid_angle > 1e-3f;
  }

  /// Density per solid angle at a point `distance` away along `wi`, from either side.
  PT_HD float pdf(const Vec3& wi, float distance) const {
    if (uses_solid_angle_sampling()) {
      const SphericalTriangle s = spherical();
      if (has_solid_angle(s)) return divide(1.0f, s.solid_angle);
    }
    const float cosine_times_area = 0.5f * fabsf(dot(normal, wi));
    return cosine_times_area > 0.0f ? divide(distance * distance, cosine_times_area) : 0.0f;
  }

  /// Where a ray along `wi` intersects its plane, within the triangle but for rounding.
  PT_HD TrianglePoint point_along(const Vec3& wi) const {
    const Vec3 p = add_scaled(-v0, divide(dot(v0, normal), dot(wi, normal)), wi);
    const float scale = divide(1.0f, dot(normal, normal));
    const auto share = [&](const Vec3& across) {
      return fminf(fmaxf(dot(across, normal) * scale, 0.0f), 1.0f);
    };
    const float b1 = share(glm::cross(p, edge2));
    return {b1, fminf(share(glm::cross(edge1, p)), 1.0f - b1)};
  }

  PT_HD TrianglePoint sample(float u0, float u1) const {
    if (uses_solid_angle_sampling()) {
      const SphericalTriangle s = spherical();
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

/// A LightError in three bytes, rounded up: the relative part to a power of two, by its exponent;
/// the absolute one to the upper half of a float.
struct PackedLightError {
  std::uint8_t relative = 0;
  std::uint16_t absolute = 0;

  PT_HD LightError unpack() const {
    return {bits_to_float(std::uint32_t{absolute} << 16),
            bits_to_float(std::uint32_t{relative} << 23)};
  }
};

/// `error` is neither negative nor NaN.
inline PackedLightError pack_light_error(const LightError& error) {
  const auto round_up = [](float x, int bits) {
    const std::uint32_t unit = 1u << bits, largest = float_to_bits(3e38f) >> bits;
    const std::uint32_t up = (float_to_bits(x) + (unit - 1)) >> bits;
    return up < largest ? up : largest;
  };
  return {static_cast<std::uint8_t>(round_up(error.relative, 23)),
          static_cast<std::uint16_t>(round_up(error.absolute, 16))};
}

/// sample_triangle_light (transport/sample_light.h) samples it. Edges, not vertices: far from the
/// origin they are more precise.
struct alignas(16) TriangleLight {
  static constexpr LightKind type = LightKind::triangle;
  static constexpr bool has_position = true;

  Vec3 vertex{0.0f};
  LightKind kind = type;
  std::uint8_t relative_error = 0;  ///< see PackedLightError
  std::uint16_t absolute_error = 0;
  Vec3 edge1{0.0f};  ///< to the second vertex
  float weight = 0.0f;
  Vec3 edge2{0.0f};                     ///< to the third vertex
  std::uint32_t triangle = no_texture;  ///< its id, if it has texture coordinates, else no_texture
  Color radiance{0.0f};
  std::uint32_t emission_texture = no_texture;

  PT_HD LightError error() const {
    return PackedLightError{relative_error, absolute_error}.unpack();
  }

  LightBounds bounds() const {
    LightBounds bounds;
    for (const Vec3& corner : {vertex, vertex + edge1, vertex + edge2}) bounds.box.grow(corner);
    const Vec3 n = glm::cross(edge1, edge2);
    if (!(glm::length(n) > 0.0f)) return bounds;
    bounds.axis = glm::normalize(n);
    bounds.emission = quarter_turn;
    bounds.intensity = weight;
    return bounds;
  }
};

struct FlippedTriangleLight : TriangleLight {
  static constexpr LightKind type = LightKind::flipped_triangle;
};

}  // namespace pt
