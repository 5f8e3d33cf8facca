#include "common/accel/build/binary/clip_triangle.h"

#include <algorithm>
#include <cmath>

namespace pt {

namespace {

using DVec3 = glm::dvec3;

/// A convex polygon: a triangle has three corners, and each of the box's planes adds at most one.
struct Polygon {
  int count = 0;
  DVec3 corner[9];

  void add(const DVec3& p) { corner[count++] = p; }
};

/// Sutherland and Hodgman's step: keeps what lies where sign * x[axis] <= sign * plane.
Polygon clip(const Polygon& polygon, int axis, double plane, double sign) {
  Polygon result;
  for (int i = 0; i < polygon.count; ++i) {
    const DVec3& a = polygon.corner[i];
    const DVec3& b = polygon.corner[(i + 1) % polygon.count];
    const double beyond_a = sign * (a[axis] - plane), beyond_b = sign * (b[axis] - plane);
    if (beyond_a <= 0) result.add(a);
    if ((beyond_a < 0 && beyond_b > 0) || (beyond_a > 0 && beyond_b < 0)) {
      DVec3 crossing = a + (beyond_a / (beyond_a - beyond_b)) * (b - a);
      crossing[axis] = plane;
      result.add(crossing);
    }
  }
  return result;
}

float round_down(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) > x ? std::nextafterf(f, -HUGE_VALF) : f;
}
float round_up(double x) { return -round_down(-x); }

}  // namespace

Bounds clipped_bounds(const Vec3 (&vertices)[3], const Bounds& box) {
  const DVec3 tolerance(hit_margin(triangle_bounds(vertices[0], vertices[1], vertices[2])));
  Polygon polygon;
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
