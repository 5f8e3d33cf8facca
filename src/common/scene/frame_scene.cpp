#include "common/scene/frame_scene.h"

#include <algorithm>
#include <map>

#include "common/geometry/primitive_bounds.h"

namespace pt {

namespace {

Bounds transformed(const Bounds& bounds, const Affine& to_world) {
  Bounds result;
  if (bounds.is_empty()) return result;
  for (int i = 0; i < 8; ++i) {
    result.grow(
        to_world.point({i & 1 ? bounds.max.x : bounds.min.x, i & 2 ? bounds.max.y : bounds.min.y,
                        i & 4 ? bounds.max.z : bounds.min.z}));
  }
  return result;
}

}  // namespace

Bounds scene_bounds(const SceneData& scene) {
  std::map<std::uint32_t, Bounds> groups;
  for (const Mesh& mesh : scene.meshes) {
    for (const Vec3& p : mesh.positions) groups[mesh.group].grow(p);
  }
  Bounds all = groups[0];
  for (const Instance& instance : scene.instances) {
    all.grow(transformed(groups[instance.group], instance.to_world));
  }
  for (const Sphere& s : scene.spheres) all.grow(sphere_bounds(s));
  for (const Quad& q : scene.quads) all.grow(quad_bounds(q));
  return all;
}

CameraParameters frame_bounds(const Bounds& bounds) {
  CameraParameters camera;
  const float radius = std::max(0.5f * glm::length(bounds.max - bounds.min), 1e-6f);
  const float half_fov = 0.5f * camera.vertical_fov_degrees * pi / 180.0f;
  camera.look_at = bounds.center();
  camera.focus_distance = radius / std::sin(half_fov);
  camera.look_from = camera.look_at + camera.focus_distance * normalize(Vec3(1.0f, 0.7f, 1.5f));
  return camera;
}

bool has_light(const SceneData& scene) {
  const auto emits = [&](std::uint32_t material) {
    return !is_black(scene.materials[material].emission);
  };
  return !is_black(scene.sky.nadir) || !is_black(scene.sky.zenith) || scene.environment.width > 0 ||
         !scene.delta_lights.empty() ||
         std::any_of(scene.meshes.begin(), scene.meshes.end(),
                     [&](const Mesh& mesh) { return emits(mesh.material); }) ||
         std::any_of(scene.sphere_material.begin(), scene.sphere_material.end(), emits) ||
         std::any_of(scene.quad_material.begin(), scene.quad_material.end(), emits);
}

}  // namespace pt
