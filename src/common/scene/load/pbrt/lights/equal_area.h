// pbrt's map of the sphere to a square that keeps areas (Clarberg 2008, 'Fast Equal-Area Mapping of
// the (Hemi)Sphere using SIMD').
#pragma once

#include <algorithm>
#include <cmath>

#include "common/math/vec.h"

namespace pt::pbrt {

/// The point of the unit square for a unit vector: the upper hemisphere, +z, is the square whose
/// corners lie in the middle of the edges.
inline Vec2 equal_area_square(const Vec3& direction) {
  const double x = std::abs(direction.x), y = std::abs(direction.y);
  const double r = std::sqrt(std::max(0.0, 1.0 - std::abs(double{direction.z})));
  const double turn = x == 0 && y == 0 ? 0 : std::atan2(y, x) * 2 / double{pi};  // of a quadrant
  double v = turn * r, u = r - v;
  if (direction.z < 0.0f) {
    std::swap(u, v);
    u = 1 - u, v = 1 - v;
  }
  return {0.5 * (std::copysign(u, double{direction.x}) + 1),
          0.5 * (std::copysign(v, double{direction.y}) + 1)};
}

}  // namespace pt::pbrt
