#include "common/scene/prepare/prepare_camera.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/error/error.h"
#include "common/geometry/primitive_bounds.h"
#include "common/scene/data/frame_scene.h"

namespace pt {
namespace {

Vec3 to_vec3(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

/// Where camera rays are before they reach the near plane, and a little more: depths from 0 to
/// `near`, within a ball.
class NearSpace {
 public:
  NearSpace(const CameraParameters& parameters, int width, int height)
      : near_(1.001f * parameters.near_clip) {
    const Camera camera = make_camera(parameters, width, height);
    origin_ = camera.origin, forward_ = camera.forward;
    const float lens = std::max(glm::length(camera.lens_x), glm::length(camera.lens_y));
    for (const float x : {-4.0f, static_cast<float>(width) + 4.0f}) {  // a filter's width beyond
      for (const float y : {-4.0f, static_cast<float>(height) + 4.0f}) {
        const Vec3 to_corner = camera.corner + x * camera.step_x + y * camera.step_y;
        const float depth = glm::dot(to_corner, forward_);
        const float reach =
            camera.is_orthographic
                ? glm::length(to_corner) + near_
                : lens + near_ * (glm::length(to_corner) + lens) / std::max(depth, 1e-30f);
        radius_ = std::max(radius_, 1.001f * reach);
      }
    }
  }

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
    const Vec3 n = glm::cross(b - a, c - a);
    return std::abs(glm::dot(n, origin_ - a)) <= radius_ * glm::length(n);
  }

 private:
  float depth_of(const Vec3& p) const { return glm::dot(p - origin_, forward_); }

  Vec3 origin_{0.0f}, forward_{0.0f};
  float near_, radius_ = 0.0f;
};

bool meets_mesh(const NearSpace& space, const Mesh& mesh) {
  return std::ranges::any_of(mesh.triangles, [&](const TriangleIndices& t) {
    return space.meets(mesh.positions[t.v[0]], mesh.positions[t.v[1]], mesh.positions[t.v[2]]);
  });
}

bool near_plane_cuts(const SceneData& scene, int width, int height) {
  const NearSpace space(scene.camera, width, height);
  for (const Sphere& s : scene.spheres) {
    if (space.meets(sphere_bounds(s))) return true;
  }
  for (const Quad& q : scene.quads) {
    if (space.meets(quad_bounds(q))) return true;
  }
  // What instances hold is not looked at one by one.
  if (!scene.instances.empty() && space.meets(scene_bounds(scene))) return true;
  return std::ranges::any_of(
      scene.meshes, [&](const Mesh& mesh) { return mesh.group == 0 && meets_mesh(space, mesh); });
}

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

void drop_idle_clips(SceneData& scene, int width, int height) {
  CameraParameters& camera = scene.camera;
  if (camera.near_clip > 0.0f && !near_plane_cuts(scene, width, height)) camera.near_clip = 0.0f;
  if (camera.far_clip >= infinite_distance) return;
  const Bounds bounds = scene_bounds(scene);
  const Vec3 forward = glm::normalize(camera.look_at - camera.look_from);
  const Vec3 farthest = glm::mix(bounds.min, bounds.max, glm::greaterThan(forward, Vec3(0.0f)));
  if (glm::dot(farthest - camera.look_from, forward) < 0.999f * camera.far_clip) {
    camera.far_clip = infinite_distance;
  }
}

}  // namespace pt
