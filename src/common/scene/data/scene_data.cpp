#include "common/scene/data/scene_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/error/error.h"
#include "common/geometry/primitives.h"

namespace pt {

std::uint32_t SceneData::add_material(const MaterialDescription& material) {
  materials.push_back(material);
  return static_cast<std::uint32_t>(materials.size() - 1);
}

void SceneData::add_sphere(const Vec3& center, float radius, std::uint32_t material) {
  spheres.push_back({center, radius * radius});
  sphere_material.push_back(material);
  if (!sphere_frames.empty()) sphere_frames.emplace_back();
}

void SceneData::add_sphere(const Vec3& center, float radius, std::uint32_t material,
                           const SphereFrame& frame) {
  sphere_frames.resize(spheres.size());
  add_sphere(center, radius, material);
  sphere_frames.resize(spheres.size());
  sphere_frames.back() = frame;
}

void SceneData::add_quad(const Vec3& corner, const Vec3& a, const Vec3& b, std::uint32_t material) {
  quads.push_back(make_quad(corner, a, b));
  quad_material.push_back(material);
}

std::uint64_t SceneData::triangle_count() const {
  std::uint64_t count = 0;
  for (const Mesh& mesh : meshes) count += mesh.triangles.size();
  return count;
}

void check_keys(const std::vector<TransformKey>& keys, const std::string& what) {
  const auto refuse = [&](const std::string& why) {
    throw Error(fmt::format("{}: {}", what, why));
  };
  if (keys.size() < 2) refuse(fmt::format("{} key of a motion; expected two or more", keys.size()));
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const Affine& map = keys[i].to_world;
    if (!is_invertible(map))
      refuse(fmt::format("key {} of its motion; expected a transform that can be inverted", i));
    if ((map.determinant() < 0.0f) != (keys[0].to_world.determinant() < 0.0f))
      refuse(fmt::format("key {} of its motion mirrors other than key 0; expected all or none", i));
    if (!std::isfinite(keys[i].time) || (i > 0 && !(keys[i].time > keys[i - 1].time)))
      refuse(
          fmt::format("key {} of its motion at {} s; expected times that ascend", i, keys[i].time));
  }
}

namespace {

/// Empty bounds have none.
std::vector<Vec3> corners(const Bounds& bounds) {
  std::vector<Vec3> result;
  if (bounds.is_empty()) return result;
  for (int i = 0; i < 8; ++i) {
    result.emplace_back(i & 1 ? bounds.max.x : bounds.min.x, i & 2 ? bounds.max.y : bounds.min.y,
                        i & 4 ? bounds.max.z : bounds.min.z);
  }
  return result;
}

Bounds transformed(const Bounds& bounds, const Affine& to_world) {
  Bounds result;
  for (const Vec3& corner : corners(bounds)) result.grow(to_world.point(corner));
  return result;
}

/// Goes back from a point until everything is within 95 % of the image's smaller side.
class Framing {
 public:
  explicit Framing(const Vec3& center) : center_(center) {}

  void include(const Vec3& p, float radius = 0.0f) {
    const Vec3 from_center = p - center_;
    const float off =
        std::max(std::abs(glm::dot(from_center, right_)), std::abs(glm::dot(from_center, up_)));
    // The distance at which the planes through the camera and the image's edges touch the point.
    const float distance = (off + radius * secant_) / tangent_ + glm::dot(from_center, backward_);
    distance_ = std::max(distance_, distance);
  }

  CameraParameters camera() const {
    CameraParameters camera = camera_;
    camera.look_at = center_;
    camera.focus_distance = distance_;
    camera.look_from = center_ + distance_ * backward_;
    return camera;
  }

 private:
  static CameraParameters any_shape() {
    CameraParameters camera;
    camera.fov_axis = FovAxis::smaller;
    return camera;
  }

  CameraParameters camera_ = any_shape();
  Vec3 center_;
  Vec3 backward_ = normalize(Vec3(1.0f, 0.7f, 1.5f));
  Vec3 right_ = normalize(glm::cross(camera_.up, backward_));
  Vec3 up_ = glm::cross(backward_, right_);
  float tangent_ = 0.95f * std::tan(0.5f * camera_.fov_degrees * pi / 180.0f);
  float secant_ = std::sqrt(1.0f + tangent_ * tangent_);
  float distance_ = 1e-6f;
};

}  // namespace

Bounds moving_sphere_bounds(const SceneData& scene, std::size_t i) {
  const MotionData::MovingSphere& moving = scene.motion.spheres[i];
  const MotionTracks& motion = scene.motion.tracks();
  const Sphere& sphere = scene.spheres[moving.sphere];
  const Vec3 own = moving.own_center(sphere.center), radius(sphere.radius());
  Bounds bounds;
  const double deviation =
      sample_poses(motion.segments, motion.spheres[i], [&](const Affine& to_world) {
        bounds.grow(to_world.point(own) - radius), bounds.grow(to_world.point(own) + radius);
      });
  // As boxes of instances that move.
  const float size = std::max(max_abs(bounds.min), max_abs(bounds.max)) + max_abs(own);
  const auto farthest = double{glm::length(own)};
  const float margin = static_cast<float>(1.001 * deviation * farthest) + 32.0f * half_ulp * size;
  return {bounds.min - Vec3(margin), bounds.max + Vec3(margin)};
}

Bounds scene_bounds(const SceneData& scene) {
  std::map<std::uint32_t, Bounds> groups;
  for (const Mesh& mesh : scene.meshes) {
    for (std::size_t set = 0; set < mesh.vertex_sets(); ++set)
      for (const Vec3& p : mesh.positions_of(set)) groups[mesh.group].grow(p);
  }
  Bounds all = groups[0];
  const MotionTracks& motion = scene.motion.tracks();
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Bounds& group = groups[scene.instances[i].group];
    const auto place = [&](const Affine& to_world) { all.grow(transformed(group, to_world)); };
    if (!motion.moves(i))
      place(scene.instances[i].to_world);
    else
      sample_poses(motion.segments, motion.instances[i], place);
  }
  std::vector<Bounds> spheres;
  for (const Sphere& s : scene.spheres) spheres.push_back(sphere_bounds(s));
  for (std::size_t i = 0; i < motion.spheres.size(); ++i)
    spheres[scene.motion.spheres[i].sphere] = moving_sphere_bounds(scene, i);
  for (const Bounds& bounds : spheres) all.grow(bounds);
  for (const Quad& q : scene.quads) all.grow(quad_bounds(q));
  return all;
}

CameraParameters frame_scene(const SceneData& scene) {
  const Bounds bounds = scene_bounds(scene);
  Framing framing(bounds.is_empty() ? Vec3(0.0f) : bounds.center());
  std::map<std::uint32_t, Bounds> groups;
  for (const Mesh& mesh : scene.meshes) {
    for (const Vec3& p : mesh.positions) {
      mesh.group == 0 ? framing.include(p) : groups[mesh.group].grow(p);
    }
  }
  for (const Instance& instance : scene.instances) {
    for (const Vec3& p : corners(groups[instance.group])) {
      framing.include(instance.to_world.point(p));
    }
  }
  for (const Sphere& s : scene.spheres) framing.include(s.center, std::sqrt(s.radius_squared));
  for (const Quad& q : scene.quads) {
    for (const Vec3& p : corners(quad_bounds(q))) framing.include(p);
  }
  return framing.camera();
}

}  // namespace pt
