// A thin-lens perspective or an orthographic camera, precomputed so that a camera ray costs nine
// multiply-adds.
#pragma once

#include <algorithm>

#include "common/geometry/ray.h"
#include "common/math/transform.h"
#include "common/sampling/warp.h"

namespace pt {

/// The side of the image along which an angle of view is measured; of the two equal sides of a
/// square either. The others follow from the image's final size.
enum class FovAxis { vertical, horizontal, diagonal, smaller, larger };

/// A camera as scenes and options describe it: lengths in scene units.
struct CameraParameters {
  Vec3 look_from{0, 0, 1};
  Vec3 look_at{0, 0, 0};
  Vec3 up{0, 1, 0};
  float fov_degrees = 40.0f;    ///< along `fov_axis`, in (0, 180)
  float aperture = 0.0f;        ///< diameter of the lens, 0: a pinhole
  float focus_distance = 1.0f;  ///< distance of the plane in perfect focus, > 0
  bool mirrored = false;        ///< left and right exchanged
  FovAxis fov_axis = FovAxis::vertical;
  Vec2 principal_point{0, 0};    ///< how far the axis lies left of and above the image's centre, in
                                 ///< parts of the image's width and height
  bool orthographic = false;     ///< parallel rays; neither angle of view nor lens
  Vec2 orthographic_size{1, 1};  ///< half the visible width; half the visible height of a square
                                 ///< image
  float near_clip = 0.0f;        ///< distance of the plane where camera rays begin
  float far_clip = infinite_distance;  ///< camera rays hit nothing behind the plane there
  bool hides_emitters = false;         ///< camera rays pass through emitters and see no environment
};

/// Puts a camera where the map puts the origin, looking along the map's z with its y up.
inline void look_along_z(const Affine& to_world, CameraParameters& camera) {
  camera.look_from = to_world.translation();
  // Far enough that rounding does not turn the view.
  const float distance = std::max(1.0f, max_abs(camera.look_from));
  camera.look_at = camera.look_from + distance * glm::normalize(to_world.vector({0, 0, 1}));
  camera.up = to_world.vector({0, 1, 0});
}

/// Whether camera rays ignore some surfaces that other rays hit.
PT_HD bool is_limited(const CameraParameters& camera) {
  return camera.far_clip < infinite_distance || camera.hides_emitters;
}

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
  Vec3 corner;             ///< from the origin to the upper left corner of the focal plane
  Vec3 step_x;             ///< one pixel to the right
  Vec3 step_y;             ///< one pixel down
  Vec3 lens_x, lens_y;     ///< half axes of the lens disk
  Vec3 forward;            ///< unit length: the axis, and the direction of all orthographic rays
  float near_clip = 0.0f;  ///< along the axis
  float near_part = 0.0f;  ///< of the way from the lens to the focal plane
  float view_length = infinite_distance;  ///< from the near to the far plane, along the axis
  bool is_orthographic = false;
  bool hides_emitters = false;
  bool is_limited = false;  ///< camera rays ignore some surfaces that other rays hit

  /// How far from the pinhole or the lens a camera ray begins.
  PT_HD float distance_of_near_plane(const Vec3& direction) const {
    return near_clip / dot(direction, forward);
  }
  /// How far along a camera ray a hit may lie.
  PT_HD float distance_in_view(const Vec3& direction) const {
    return fminf(view_length / dot(direction, forward), infinite_distance);
  }
};

/// `parameters` must describe a camera: see check_camera.
PT_HD Camera make_camera(const CameraParameters& parameters, int width, int height) {
  const Vec3 backward = normalize(parameters.look_from - parameters.look_at);
  const Vec3 right = normalize(glm::cross(parameters.up, backward));
  const Vec3 up = glm::cross(backward, right);
  const bool orthographic = parameters.orthographic;
  const float plane_height =
      2.0f * parameters.focus_distance * vertical_tangent(parameters, width, height);
  const float pixel = plane_height / static_cast<float>(height);
  const Vec2 size = parameters.orthographic_size * (2.0f / static_cast<float>(width));
  const float pixel_x = orthographic ? size.x : pixel, pixel_y = orthographic ? size.y : pixel;
  const Vec3 step_x = (parameters.mirrored ? -pixel_x : pixel_x) * right;
  const Vec3 step_y = -pixel_y * up;
  const float plane_distance = orthographic ? 0.0f : parameters.focus_distance;
  const float lens_radius = orthographic ? 0.0f : 0.5f * parameters.aperture;
  Camera camera{parameters.look_from - (orthographic ? parameters.near_clip : 0.0f) * backward,
                -plane_distance * backward - 0.5f * static_cast<float>(width) * step_x -
                    0.5f * static_cast<float>(height) * step_y,
                step_x,
                step_y,
                lens_radius * right,
                lens_radius * up,
                -backward,
                parameters.near_clip,
                orthographic ? 0.0f : parameters.near_clip / plane_distance,
                parameters.far_clip - parameters.near_clip,
                orthographic,
                parameters.hides_emitters};
  const Vec2& shift = parameters.principal_point;
  if (shift.x != 0.0f || shift.y != 0.0f) {
    camera.corner += shift.x * static_cast<float>(width) * step_x +
                     shift.y * static_cast<float>(height) * step_y;
  }
  camera.is_limited = is_limited(parameters);
  return camera;
}

/// The camera where `pose` brings it.
PT_HD Camera moved(Camera camera, const Affine& pose) {
  camera.origin = pose.point(camera.origin);
  for (Vec3* vector : {&camera.corner, &camera.step_x, &camera.step_y, &camera.lens_x,
                       &camera.lens_y, &camera.forward})
    *vector = pose.vector(*vector);
  camera.forward = normalize(camera.forward);
  return camera;
}

/// The film position, in pixels, of a point as seen through the middle of the lens; false for one
/// that is not before the camera.
PT_HD bool film_position(const Camera& camera, const Vec3& point, Vec2& position) {
  const auto volume = [](const Vec3& a, const Vec3& b, const Vec3& c) {
    return dot(a, glm::cross(b, c));
  };
  // Of a multiple of `axis` and the steps it is the way to the point.
  const bool parallel = camera.is_orthographic;
  const Vec3 axis = parallel ? camera.forward : camera.corner;
  const Vec3 way = point - camera.origin - (parallel ? camera.corner : Vec3(0.0f));
  const float whole = volume(axis, camera.step_x, camera.step_y);
  const float along = volume(way, camera.step_x, camera.step_y) / whole;
  if (!(along > 0.0f)) return false;
  const Vec2 steps(volume(axis, way, camera.step_y), volume(axis, camera.step_x, way));
  position = steps / (parallel ? whole : along * whole);
  return true;
}

/// The ray through film position (x, y), in pixels; `u` in [0, 1)^2 chooses the point of the lens.
/// `specialized`: the camera is none of parallel rays.
template <bool specialized = false>
PT_HD Ray camera_ray(const Camera& camera, float x, float y, float u0, float u1) {
  const Disk lens = sample_unit_disk(u0, u1);
  const Vec3 offset = add_scaled(lens.x * camera.lens_x, lens.y, camera.lens_y);
  const Vec3 to_focus = add_scaled(add_scaled(camera.corner, x, camera.step_x), y, camera.step_y);
  if (!specialized && camera.is_orthographic) return {camera.origin + to_focus, camera.forward};
  const Vec3 way = to_focus - offset;
  return {add_scaled(camera.origin + offset, camera.near_part, way), normalize(way)};
}

}  // namespace pt
