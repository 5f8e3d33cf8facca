#include "common/scene/load/gltf/cameras.h"

#include <algorithm>

namespace pt::gltf {

namespace {

constexpr int image_height = 720;  // glTF gives an aspect ratio and no size

void set_image_shape(double aspect, SceneData& scene) {
  if (!(aspect > 0.0)) return;
  scene.defaults.height = image_height;
  scene.defaults.width =
      static_cast<int>(std::clamp(std::round(aspect * image_height), 1.0, 65535.0));
}

float to_degrees(double radians) { return static_cast<float>(radians * 180.0 / 3.14159265358979); }

void set_perspective(const File& file, const tinygltf::PerspectiveCamera& source,
                     const std::string& place, SceneData& scene) {
  if (!(source.yfov > 0.0 && source.yfov < 3.14159265)) {
    file.fail(place + ".perspective.yfov",
              fmt::format("{}: expected radians between 0 and pi", source.yfov));
  }
  scene.camera.fov_degrees = to_degrees(source.yfov);
  set_image_shape(source.aspectRatio, scene);
}

void set_orthographic(File& file, const tinygltf::OrthographicCamera& source,
                      const std::string& place, SceneData& scene) {
  file.report(place,
              "orthographic camera: a perspective one with a field of view of 5 degrees is "
              "used, which sees as much at the scene's middle");
  const double half_height = std::abs(source.ymag);
  if (!(half_height > 0.0) || !std::isfinite(static_cast<float>(half_height))) {
    file.fail(place + ".orthographic.ymag", "expected a number that is not 0");
  }
  CameraParameters& camera = scene.camera;
  camera.fov_degrees = 5.0f;
  const double distance = half_height / std::tan(2.5 * 3.14159265358979 / 180.0);
  const Vec3 direction = normalize(camera.look_at - camera.look_from);
  camera.look_from = camera.look_at - static_cast<float>(distance) * direction;
  camera.focus_distance = static_cast<float>(distance);
  set_image_shape(std::abs(source.xmag) / half_height, scene);
}

/// Looks along the node's -z with +y up; its scale has no effect (specification, section 3.10).
void set_pose(const File& file, const PlacedNode& node, const Bounds& bounds,
              CameraParameters& camera) {
  const Vec3 forward = node.to_world.vector({0, 0, -1});
  const Vec3 up = node.to_world.vector({0, 1, 0});
  const Vec3 side = glm::cross(forward, up);
  if (!(glm::length(forward) > 0.0f && glm::length(up) > 0.0f && glm::length(side) > 0.0f)) {
    file.fail(node_place(node.node), "the camera's transformation is singular");
  }
  const Vec3 direction = normalize(forward);
  camera.look_from = node.to_world.translation();
  // Focused on the middle of the scene: it matters once a user opens the aperture.
  const float depth = glm::dot(bounds.center() - camera.look_from, direction);
  camera.focus_distance = depth > 0.0f && std::isfinite(depth) ? depth : 1.0f;
  camera.look_at = camera.look_from + camera.focus_distance * direction;
  camera.up = normalize(up);
}

}  // namespace

bool set_camera(File& file, const std::vector<PlacedNode>& nodes, const Bounds& bounds,
                SceneData& scene) {
  for (const PlacedNode& node : nodes) {
    const int index = file.model.nodes[static_cast<std::size_t>(node.node)].camera;
    if (index < 0) continue;
    const auto& source =
        file.at(file.model.cameras, index, "cameras", node_place(node.node) + ".camera");
    const std::string place = fmt::format("cameras[{}]", index);
    set_pose(file, node, bounds, scene.camera);
    if (source.type == "perspective") {
      set_perspective(file, source.perspective, place, scene);
    } else {
      set_orthographic(file, source.orthographic, place, scene);
    }
    return true;
  }
  return false;
}

}  // namespace pt::gltf
