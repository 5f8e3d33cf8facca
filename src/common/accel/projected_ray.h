// A ray as the scans of brute force see spheres.
#pragma once

#include "common/geometry/sphere.h"
#include "common/math/frame.h"

namespace pt {

/// A ray as seen along its own direction: what lies on it lies at the origin of a plane. A sphere's
/// centre falls on the point (dot(x_axis, centre) - x, dot(y_axis, centre) - y) of that plane, and
/// the line meets the sphere when this point is within the radius: nine operations per sphere, less
/// than any test in three dimensions.
class ProjectedRay {
 public:
  PT_HD ProjectedRay(const Ray& ray, const Vec3& scan_center) {
    const Frame frame = make_frame(ray.direction);
    const Vec3 origin = ray.origin - scan_center;
    x_axis_ = frame.tangent;
    y_axis_ = frame.bitangent;
    x_ = glm::dot(x_axis_, origin);
    y_ = glm::dot(y_axis_, origin);
  }

  PT_HD const Vec3& x_axis() const { return x_axis_; }
  PT_HD const Vec3& y_axis() const { return y_axis_; }
  PT_HD float x() const { return x_; }
  PT_HD float y() const { return y_; }

  /// Negative when the line misses the sphere, one of Primitives::scan.
  PT_HD float nearness(const Sphere& sphere) const {
    const Vec3& c = sphere.center;
    const float x = c.x * x_axis_.x + (c.y * x_axis_.y + (c.z * x_axis_.z - x_));
    const float y = c.x * y_axis_.x + (c.y * y_axis_.y + (c.z * y_axis_.z - y_));
    return sphere.radius_squared - x * x - y * y;
  }

 private:
  Vec3 x_axis_, y_axis_;
  float x_, y_;
};

}  // namespace pt
