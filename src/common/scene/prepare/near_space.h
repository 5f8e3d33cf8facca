// Where an image's camera rays are before they reach the near plane.
#pragma once

#include <algorithm>
#include <vector>

#include "common/geometry/bounds.h"
#include "common/geometry/convex_polygon.h"
#include "common/scene/data/camera.h"

namespace pt {

/// A pyramid without its top, or a box of parallel rays, and a little more.
class NearSpace {
 public:
  NearSpace(const CameraParameters& parameters, int width, int height)
      : near_(1.001f * parameters.near_clip) {
    const Camera camera = make_camera(parameters, width, height);
    origin_ = camera.origin, forward_ = camera.forward;
    add_side(-forward_, 0);
    add_side(forward_, near_);
    const float lens = std::max(glm::length(camera.lens_x), glm::length(camera.lens_y));
    for (const Vec3& step : {camera.step_x, camera.step_y, -camera.step_x, -camera.step_y}) {
      const Vec3 outward = glm::normalize(step);
      float most = -HUGE_VALF;  // by depth, or of parallel rays
      for_each_corner(camera, width, height, [&](const Vec3& to_corner) {
        const float depth = std::max(glm::dot(to_corner, forward_), 1e-30f);
        const float beside = glm::dot(to_corner, outward);
        most = std::max(most, camera.is_orthographic ? beside : (beside + lens) / depth);
        const float reach = camera.is_orthographic
                                ? glm::length(to_corner) + near_
                                : lens + near_ * (glm::length(to_corner) + lens) / depth;
        radius_ = std::max(radius_, 1.001f * reach);
      });
      if (camera.is_orthographic) {
        add_side(outward, most + 0.001f * std::abs(most));
      } else {
        add_side(outward - (most + 0.001f * (1 + std::abs(most))) * forward_, lens);
      }
    }
  }

  /// May say so of a box that is near.
  bool meets(const Bounds& box) const {
    const Vec3 nearest = glm::clamp(origin_, box.min, box.max);
    float least = HUGE_VALF, most = -HUGE_VALF;
    for (int corner = 0; corner < 8; ++corner) {
      const float depth =
          depth_of({(corner & 1 ? box.max : box.min).x, (corner & 2 ? box.max : box.min).y,
                    (corner & 4 ? box.max : box.min).z});
      least = std::min(least, depth), most = std::max(most, depth);
    }
    return glm::length(nearest - origin_) <= radius_ && least <= near_ && most >= 0.0f;
  }

  bool meets(const Vec3& a, const Vec3& b, const Vec3& c) const {
    const auto [least, most] = std::minmax({depth_of(a), depth_of(b), depth_of(c)});
    if (least > near_ || most < 0.0f) return false;
    Bounds box;
    box.grow(a), box.grow(b), box.grow(c);
    if (!meets(box)) return false;
    ConvexPolygon part;
    for (const Vec3& p : {a, b, c}) part.add(glm::dvec3(p) - glm::dvec3(origin_));
    for (const Side& side : sides_) part = part_inside(part, side);
    return part.count > 0;
  }

 private:
  /// Inside is where dot(normal, p - origin) <= most.
  struct Side {
    glm::dvec3 normal;
    double most;
  };

  void add_side(const Vec3& normal, float most) { sides_.push_back({glm::dvec3(normal), most}); }

  static ConvexPolygon part_inside(const ConvexPolygon& polygon, const Side& side) {
    return clip(
        polygon, [&](const glm::dvec3& p) { return glm::dot(side.normal, p) - side.most; },
        [](const glm::dvec3&) {});
  }

  template <class Visit>
  static void for_each_corner(const Camera& camera, int width, int height, Visit&& visit) {
    for (const float x : {-4.0f, static_cast<float>(width) + 4.0f}) {  // a filter's width beyond
      for (const float y : {-4.0f, static_cast<float>(height) + 4.0f}) {
        visit(camera.corner + x * camera.step_x + y * camera.step_y);
      }
    }
  }

  float depth_of(const Vec3& p) const { return glm::dot(p - origin_, forward_); }

  Vec3 origin_{0.0f}, forward_{0.0f};
  float near_, radius_ = 0.0f;  ///< of a ball around all
  std::vector<Side> sides_;
};

}  // namespace pt
