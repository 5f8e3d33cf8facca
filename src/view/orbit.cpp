#include "view/orbit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pt {
namespace {

using Wide = glm::dvec3;

constexpr double degree = std::numbers::pi / 180;
constexpr double most_elevation = 89 * degree;

/// The vector from the point looked at to the camera, split along and across the up vector.
struct Offset {
  explicit Offset(const CameraParameters& camera)
      : axis(glm::normalize(Wide(camera.up))),
        all(Wide(camera.look_from) - Wide(camera.look_at)),
        flat(all - glm::dot(all, axis) * axis),
        elevation(std::atan2(glm::dot(all, axis), glm::length(flat))) {}

  double steepest() const { return std::max(most_elevation, std::abs(elevation)); }

  Wide axis, all, flat;
  double elevation;  ///< radians
};

}  // namespace

PitchRange pitch_range(const CameraParameters& camera) {
  const Offset offset(camera);
  return {(-offset.steepest() - offset.elevation) / degree,
          (offset.steepest() - offset.elevation) / degree};
}

CameraParameters orbit_camera(const CameraParameters& camera, const Orbit& orbit) {
  if (orbit == Orbit()) return camera;
  const Offset offset(camera);
  const Wide ahead = glm::normalize(offset.flat), aside = glm::cross(offset.axis, ahead);
  const double elevation =
      std::clamp(offset.elevation + orbit.pitch * degree, -offset.steepest(), offset.steepest());
  const double turn = (camera.mirrored ? -orbit.yaw : orbit.yaw) * degree;
  const Wide level = std::cos(turn) * ahead + std::sin(turn) * aside;
  const Wide direction = std::cos(elevation) * level + std::sin(elevation) * offset.axis;

  CameraParameters moved = camera;
  const auto zoom = static_cast<float>(orbit.zoom);
  moved.look_from = Vec3(Wide(camera.look_at) + orbit.zoom * glm::length(offset.all) * direction);
  moved.focus_distance *= zoom;
  moved.orthographic_size *= zoom;
  return moved;
}

}  // namespace pt
