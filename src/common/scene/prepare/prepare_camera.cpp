#include <fmt/format.h>

#include <algorithm>

#include "common/error/error.h"
#include "common/geometry/primitives.h"
#include "common/scene/data/scene_data.h"
#include "common/scene/prepare/prepare_steps.h"

namespace pt {
namespace {

Vec3 to_vec3(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

}  // namespace

void override_camera(CameraParameters& camera, const CameraOverrides& overrides) {
  if (overrides.look_from) camera.look_from = to_vec3(*overrides.look_from);
  if (overrides.look_at) camera.look_at = to_vec3(*overrides.look_at);
  if (overrides.up) camera.up = to_vec3(*overrides.up);
  if (overrides.vertical_fov_degrees) {
    camera.orthographic = false;
    camera.fov_degrees = *overrides.vertical_fov_degrees;
    camera.fov_axis = FovAxis::vertical;
  }
  if (camera.orthographic && (overrides.aperture || overrides.focus_distance)) {
    throw Error(
        fmt::format("--{}: the scene's camera is orthographic and has no lens; expected "
                    "--fov as well, which makes it a perspective one",
                    overrides.aperture ? "aperture" : "focus-distance"));
  }
  camera.aperture = overrides.aperture.value_or(camera.aperture);
  if (overrides.focus_distance && camera.aperture == 0.0f) {
    throw Error(
        fmt::format("--focus-distance {}: has no effect in the scene's pinhole camera; expected "
                    "--aperture as well, which gives it a lens",
                    *overrides.focus_distance));
  }
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

void drop_idle_far_plane(SceneData& scene) {
  CameraParameters& camera = scene.camera;
  if (camera.far_clip >= infinite_distance) return;
  const Bounds bounds = scene_bounds(scene);
  const Vec3 forward = glm::normalize(camera.look_at - camera.look_from);
  const Vec3 farthest = glm::mix(bounds.min, bounds.max, glm::greaterThan(forward, Vec3(0.0f)));
  if (glm::dot(farthest - camera.look_from, forward) < 0.999f * camera.far_clip) {
    camera.far_clip = infinite_distance;
  }
}

float camera_extent(const CameraParameters& parameters, int width, int height) {
  constexpr float filter = 4.0f;  // pixels that a filter reaches beyond the image, and more
  Camera camera = make_camera(parameters, width, height);
  const float lens = std::max(glm::length(camera.lens_x), glm::length(camera.lens_y));
  camera.lens_x = camera.lens_y = Vec3(0.0f);
  float extent = 0.0f;
  for (const float x : {-filter, static_cast<float>(width) + filter}) {
    for (const float y : {-filter, static_cast<float>(height) + filter}) {
      const Vec3 origin = camera_ray(camera, x, y, 0.0f, 0.0f).origin;
      extent = std::max(extent, glm::length(origin - parameters.look_from));
    }
  }
  return 1.001f * (extent + lens * (1.0f + camera.near_part));
}

}  // namespace pt
