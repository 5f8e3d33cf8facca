// Convex polygons that are cut by planes, on the host.
#pragma once

#include "common/math/vec.h"

namespace pt {

/// A triangle has three corners, and each plane that cuts it adds at most one.
struct ConvexPolygon {
  static constexpr int planes_max = 6;
  int count = 0;
  glm::dvec3 corner[3 + planes_max];

  void add(const glm::dvec3& p) { corner[count++] = p; }
};

/// What lies where beyond(p), a signed distance from a plane or a multiple of it, is not positive
/// (Sutherland and Hodgman 1974, 'Reentrant Polygon Clipping'). settle(p) may move a new corner
/// onto the plane.
template <class Beyond, class Settle>
ConvexPolygon clip(const ConvexPolygon& polygon, const Beyond& beyond, const Settle& settle) {
  ConvexPolygon result;
  for (int i = 0; i < polygon.count; ++i) {
    const glm::dvec3& a = polygon.corner[i];
    const glm::dvec3& b = polygon.corner[(i + 1) % polygon.count];
    const double beyond_a = beyond(a), beyond_b = beyond(b);
    if (beyond_a <= 0) result.add(a);
    if ((beyond_a < 0 && beyond_b > 0) || (beyond_a > 0 && beyond_b < 0)) {
      glm::dvec3 crossing = a + (beyond_a / (beyond_a - beyond_b)) * (b - a);
      settle(crossing);
      result.add(crossing);
    }
  }
  return result;
}

}  // namespace pt
