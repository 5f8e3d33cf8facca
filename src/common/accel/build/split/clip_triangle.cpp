#include "common/accel/build/split/clip_triangle.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/convex_polygon.h"

namespace pt {

namespace {

using DVec3 = glm::dvec3;

/// What lies where sign * x[axis] <= sign * plane.
ConvexPolygon clip(const ConvexPolygon& polygon, int axis, double plane, double sign) {
  return clip(
      polygon, [&](const DVec3& p) { return sign * (p[axis] - plane); },
      [&](DVec3& crossing) { crossing[axis] = plane; });
}

float round_down(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) > x ? std::nextafterf(f, -HUGE_VALF) : f;
}
float round_up(double x) { return -round_down(-x); }

}  // namespace

Bounds clipped_bounds(const Vec3 (&vertices)[3], const Bounds& box) {
  const DVec3 tolerance(hit_margin(triangle_bounds(vertices[0], vertices[1], vertices[2])));
  ConvexPolygon polygon;
  for (const Vec3& v : vertices) polygon.add(DVec3(v));
  for (int axis = 0; axis < 3; ++axis) {
    polygon = clip(polygon, axis, box.max[axis] + tolerance[axis], 1);
    polygon = clip(polygon, axis, box.min[axis] - tolerance[axis], -1);
  }
  if (polygon.count == 0) return {};
  DVec3 low(HUGE_VAL), high(-HUGE_VAL);
  for (int i = 0; i < polygon.count; ++i) {
    low = glm::min(low, polygon.corner[i]), high = glm::max(high, polygon.corner[i]);
  }
  Bounds result;
  for (int axis = 0; axis < 3; ++axis) {
    result.min[axis] =
        std::clamp(round_down(low[axis] - tolerance[axis]), box.min[axis], box.max[axis]);
    result.max[axis] =
        std::clamp(round_up(high[axis] + tolerance[axis]), box.min[axis], box.max[axis]);
  }
  return result;
}

}  // namespace pt
