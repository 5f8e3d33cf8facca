// Sampling a triangle uniformly by the solid angle under which it is seen (Arvo 1995, 'Stratified
// Sampling of Spherical Triangles'), with the half-angle form of Peters (2021, 'BRDF Importance
// Sampling for Polygonal Lights'), which needs no arc functions but one.
#pragma once

#include "common/math/functions.h"
#include "common/math/vec.h"

namespace pt {

/// A triangle as seen from the origin.
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
    solid_angle = 2.0f * atan2f(volume, add_rounded(1.0f + dot(a, b), dot(b, c) + dot(c, a)));
  }

  /// A unit vector into it, uniform in solid angle.
  PT_HD Vec3 sample(float u0, float u1) const {
    // The corner c moves towards a until the rest, between a, b and it, has the share u0.
    const SinCos half = sincos_2pi(0.25f * inverse_pi * u0 * solid_angle);
    const float to_a =
        fused_multiply_add(volume, half.cos, -multiply_rounded(dot(b, c) + dot(c, a), half.sin));
    const float to_c = (1.0f + dot(a, b)) * half.sin;
    const Vec3 middle = add_scaled(to_a * a, to_c, c);
    const float turn = divide(2.0f * dot(a, middle), fmaxf(dot(middle, middle), 1e-30f));
    const Vec3 moved = add_scaled(-a, turn, middle);
    // On the arc from b to it, uniform in the cosine of the angle to b.
    const Vec3 apart = moved - b;
    const float h = multiply_rounded(0.5f * u1, dot(apart, apart));  // 1 - cos
    const Vec3 across = add_scaled(moved, -dot(moved, b), b);
    const float sine = square_root(fmaxf(0.0f, h * (2.0f - h)));
    const float scale = sine * inverse_sqrt(fmaxf(dot(across, across), 1e-30f));
    return normalize(add_scaled(add_scaled(b, -h, b), scale, across));
  }
};

}  // namespace pt
