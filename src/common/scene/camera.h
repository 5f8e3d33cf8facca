// A thin-lens perspective camera, precomputed so that a camera ray costs six multiply-adds.
#pragma once

#include "common/geometry/ray.h"
#include "common/sampling/warp.h"

namespace pt {

/// The side of the image along which an angle of view is measured; of the two equal sides of a
/// square either. The others follow from the image's final size.
enum class FovAxis { vertical, horizontal, diagonal, smaller, larger };

/// What a user says of a camera: lengths in scene units.
struct CameraParameters {
  Vec3 look_from{0, 0, 1};
  Vec3 look_at{0, 0, 0};
  Vec3 up{0, 1, 0};
  float fov_degrees = 40.0f;    ///< along `fov_axis`, in (0, 180)
  float aperture = 0.0f;        ///< diameter of the lens, 0: a pinhole
  float focus_distance = 1.0f;  ///< distance of the plane in perfect focus, > 0
  bool mirrored = false;        ///< left and right exchanged
  FovAxis fov_axis = FovAxis::vertical;
};

/// The tangent of half the vertical angle of view of an image of this size.
PT_HD float vertical_tangent(const CameraParameters& parameters, int width, int height) {
  const float tangent = tanf(0.5f * parameters.fov_degrees * pi / 180.0f);
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  switch (parameters.fov_axis) {
    case FovAxis::horizontal:
      return tangent / aspect;
    case FovAxis::diagonal:
      return tangent / sqrtf(1.0f + aspect * aspect);
    case FovAxis::smaller:
      return aspect < 1.0f ? tangent / aspect : tangent;
    case FovAxis::larger:
      return aspect > 1.0f ? tangent / aspect : tangent;
    default:
      return tangent;
  }
}

/// Directions are relative to `origin`; pixel (0, 0) is the upper left corner.
struct Camera {
  Vec3 origin;
  Vec3 corner;          ///< from the origin to the upper left corner of the focal plane
  Vec3 step_x;          ///< one pixel to the right
  Vec3 step_y;          ///< one pixel down
  Vec3 lens_x, lens_y;  ///< half axes of the lens disk
};

/// `parameters` must describe a camera: see check_camera.
PT_HD Camera make_camera(const CameraParameters& parameters, int width, int height) {
  const Vec3 backward = normalize(parameters.look_from - parameters.look_at);
  const Vec3 right = normalize(glm::cross(parameters.up, backward));
  const Vec3 up = glm::cross(backward, right);
  const float plane_height =
      2.0f * parameters.focus_distance * vertical_tangent(parameters, width, height);
  const float pixel = plane_height / static_cast<float>(height);
  const Vec3 step_x = (parameters.mirrored ? -pixel : pixel) * right;
  const Vec3 step_y = -pixel * up;
  const float lens_radius = 0.5f * parameters.aperture;
  return {parameters.look_from,
          -parameters.focus_distance * backward - 0.5f * static_cast<float>(width) * step_x -
              0.5f * static_cast<float>(height) * step_y,
          step_x,
          step_y,
          lens_radius * right,
          lens_radius * up};
}

/// The ray through film position (x, y), in pixels; `u` in [0, 1)^2 chooses the point of the lens.
PT_HD Ray camera_ray(const Camera& camera, float x, float y, float u0, float u1) {
  const Disk lens = sample_unit_disk(u0, u1);
  const Vec3 offset = lens.x * camera.lens_x + lens.y * camera.lens_y;
  const Vec3 to_focus = camera.corner + x * camera.step_x + y * camera.step_y;
  return {camera.origin + offset, normalize(to_focus - offset)};
}

}  // namespace pt
