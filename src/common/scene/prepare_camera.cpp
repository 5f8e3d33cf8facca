#include "common/scene/prepare_camera.h"

#include <fmt/format.h>

#include "common/error.h"

namespace pt {
namespace {

Vec3 to_vec3(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

}  // namespace

void override_camera(CameraParameters& camera, const CameraOverrides& overrides) {
  if (overrides.look_from) camera.look_from = to_vec3(*overrides.look_from);
  if (overrides.look_at) camera.look_at = to_vec3(*overrides.look_at);
  if (overrides.up) camera.up = to_vec3(*overrides.up);
  if (overrides.vertical_fov_degrees) {
    camera.fov_degrees = *overrides.vertical_fov_degrees;
    camera.fov_axis = FovAxis::vertical;
  }
  camera.aperture = overrides.aperture.value_or(camera.aperture);
  camera.focus_distance = overrides.focus_distance.value_or(camera.focus_distance);
}

void check_camera(const CameraParameters& camera) {
  const Vec3 backward = camera.look_from - camera.look_at;
  if (!(glm::dot(backward, backward) > 0.0f)) {
    throw Error(
        "--look-from and --look-at are the same point or not finite; the camera needs a direction");
  }
  const Vec3 side = glm::cross(camera.up, backward);
  if (!(glm::dot(side, side) >
        1e-12f * glm::dot(camera.up, camera.up) * glm::dot(backward, backward))) {
    throw Error("--up is zero or parallel to the view direction; choose another vector");
  }
  if (!(camera.fov_degrees > 0.0f && camera.fov_degrees < 180.0f)) {
    throw Error(fmt::format("--fov {}: expected degrees between 0 and 180, both excluded",
                            camera.fov_degrees));
  }
  if (!(camera.aperture >= 0.0f)) {
    throw Error(fmt::format("--aperture {}: expected a diameter >= 0", camera.aperture));
  }
  if (!(camera.focus_distance > 0.0f)) {
    throw Error(fmt::format("--focus-distance {}: expected a distance > 0", camera.focus_distance));
  }
}

}  // namespace pt
