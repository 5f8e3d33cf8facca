// Cameras, and lights by KHR_lights_punctual.
#include <algorithm>
#include <cmath>
#include <optional>

#include "common/scene/load/gltf/document.h"
#include "common/scene/load/gltf/nodes.h"

namespace pt::gltf {
namespace {

constexpr int image_height = 720;  // glTF gives an aspect ratio and no size

void set_image_shape(double aspect, SceneData& scene) {
  if (!(aspect > 0.0) || !std::isfinite(aspect)) return;
  scene.defaults.height = image_height;
  scene.defaults.width =
      static_cast<int>(std::clamp(std::round(aspect * image_height), 1.0, 65535.0));
}

float to_degrees(double radians) { return static_cast<float>(radians * 180.0 / 3.14159265358979); }

void set_perspective(File& file, const tinygltf::PerspectiveCamera& source,
                     const std::string& place, SceneData& scene) {
  if (source.yfov > 0.0 && source.yfov < 3.14159265) {
    scene.camera.fov_degrees = to_degrees(source.yfov);
  } else {
    file.report(place + ".perspective.yfov",
                "{}: expected radians between 0 and pi: {} degrees are used", source.yfov,
                scene.camera.fov_degrees);
  }
  set_image_shape(source.aspectRatio, scene);
}

/// The image's width shows 2 xmag, whatever its shape; pixels are square. Rays begin at znear and
/// end at zfar.
void set_orthographic(File& file, const tinygltf::OrthographicCamera& source,
                      const std::string& place, SceneData& scene) {
  const auto magnitude = [&](double value, const char* key) {
    const double size = std::abs(value);
    if (size > 0.0 && std::isfinite(static_cast<float>(size))) return size;
    file.report(place + ".orthographic." + key,
                "expected a number that is not 0: square pixels decide");
    return 0.0;
  };
  double half_width = magnitude(source.xmag, "xmag"), half_height = magnitude(source.ymag, "ymag");
  if (half_width == 0.0) half_width = half_height > 0.0 ? half_height : 1.0;
  if (half_height == 0.0) half_height = half_width;
  CameraParameters& camera = scene.camera;
  camera.orthographic = true;
  camera.orthographic_size = Vec2(static_cast<float>(half_width));
  set_image_shape(half_width / half_height, scene);
  if (source.znear >= 0.0 && source.zfar > source.znear) {
    camera.near_clip = static_cast<float>(source.znear);
    camera.far_clip = std::min(static_cast<float>(source.zfar), infinite_distance);
  } else {
    file.report(place + ".orthographic",
                "znear {}, zfar {}: expected 0 <= znear < zfar: nothing is cut off", source.znear,
                source.zfar);
  }
}

/// Where the node's axes and place take a camera, without their scale.
Affine camera_pose(const Affine& to_world) {
  const Vec3 back = normalize(to_world.vector({0, 0, 1})), up = to_world.vector({0, 1, 0});
  const Vec3 right = normalize(glm::cross(up, back)), above = glm::cross(back, right);
  Affine pose;
  for (int i = 0; i < 3; ++i)
    pose.row[i] = {-right[i], above[i], -back[i], to_world.translation()[i]};
  return pose;
}

/// Looks along the node's -z with +y up; its scale has no effect (specification, section 3.10).
/// False, and a warning, for a node that has no such directions.
bool set_pose(File& file, const PlacedNode& node, const Bounds& bounds, CameraParameters& camera) {
  const Vec3 forward = node.to_world.vector({0, 0, -1});
  const Vec3 up = node.to_world.vector({0, 1, 0});
  const Vec3 side = glm::cross(forward, up);
  if (!(glm::length(forward) > 0.0f && glm::length(up) > 0.0f && glm::length(side) > 0.0f)) {
    file.report(node_place(node.node),
                "the camera's transformation is singular: the camera is left out");
    return false;
  }
  const Vec3 direction = normalize(forward);
  camera.look_from = node.to_world.translation();
  // Focused on the middle of the scene: it matters once a user opens the aperture.
  const float depth = glm::dot(bounds.center() - camera.look_from, direction);
  camera.focus_distance = depth > 0.0f && std::isfinite(depth) ? depth : 1.0f;
  camera.look_at = camera.look_from + camera.focus_distance * direction;
  camera.up = normalize(up);
  return true;
}

}  // namespace

bool set_camera(File& file, const std::vector<PlacedNode>& nodes, const Bounds& bounds,
                SceneData& scene) {
  for (const PlacedNode& node : nodes) {
    const int index = file.model.nodes[static_cast<std::size_t>(node.node)].camera;
    if (index < 0 ||
        !file.has(file.model.cameras, index, "cameras", node_place(node.node) + ".camera",
                  "the node has no camera") ||
        !set_pose(file, node, bounds, scene.camera)) {
      continue;
    }
    for (const TransformKey& key : node.keys)
      scene.motion.camera.push_back({key.time, camera_pose(key.to_world)});
    const tinygltf::Camera& source = file.model.cameras[static_cast<std::size_t>(index)];
    const std::string place = fmt::format("cameras[{}]", index);
    if (source.type == "perspective") {
      set_perspective(file, source.perspective, place, scene);
    } else {
      set_orthographic(file, source.orthographic, place, scene);
    }
    return true;
  }
  return false;
}

namespace {

/// Black where the lamp has no colour that could be used.
Color light_color(File& file, const tinygltf::Light& source, const std::string& place) {
  Color color(1.0f);
  if (source.color.size() == 3) {
    for (int i = 0; i < 3; ++i) {
      color[i] = static_cast<float>(source.color[static_cast<std::size_t>(i)]);
    }
  } else if (!source.color.empty()) {
    file.report(place + ".color", "expected three numbers: white is used");
  }
  color *= static_cast<float>(source.intensity);
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(color[i]) || color[i] < 0.0f) {
      file.report(place, "expected a finite color and intensity >= 0: the lamp is left out");
      return Color(0.0f);
    }
  }
  return color;
}

/// Equal angles are a cone with a hard rim: exporters write them for lamps without a soft one.
void set_cone(File& file, const tinygltf::SpotLight& spot, const std::string& place,
              DeltaLight& light) {
  constexpr double largest = 1.57079632679489662;
  double outer = spot.outerConeAngle, inner = spot.innerConeAngle;
  if (!(outer > 0.0 && outer < largest + 1e-4)) {
    outer = outer > 0.0 ? largest : 0.5 * largest;
    file.report_value(place + ".spot", "outerConeAngle",
                      "outerConeAngle {}: expected 0 < outerConeAngle <= pi / 2: {:.6g} is used",
                      spot.outerConeAngle, outer);
  }
  if (!(inner >= 0.0 && inner <= spot.outerConeAngle)) {
    inner = std::clamp(inner, 0.0, outer);
    file.report_value(
        place + ".spot", "innerConeAngle",
        "innerConeAngle {}: expected 0 <= innerConeAngle <= outerConeAngle: {:.6g} is used",
        spot.innerConeAngle, inner);
  }
  outer = std::min(outer, largest);
  inner = std::min(inner, outer);
  light.cos_inner = static_cast<float>(std::cos(inner));
  light.cos_outer = static_cast<float>(std::cos(outer));
}

std::optional<DeltaLight> make_light(File& file, const tinygltf::Light& source,
                                     const Affine& to_world, const std::string& place) {
  DeltaLight light;
  light.position = to_world.translation();
  if (source.type == "spot" || source.type == "directional") {
    const Vec3 direction = to_world.vector({0, 0, -1});
    if (!(glm::length(direction) > 0.0f)) {
      file.report(place, "its node's transformation is singular: the lamp is left out");
      return std::nullopt;
    }
    light.direction = normalize(direction);
  }
  if (source.type == "spot") {
    light.kind = LightKind::spot;
    light.falloff = SpotFalloff::square_cosine;
    set_cone(file, source.spot, place, light);
  } else if (source.type == "directional") {
    light.kind = LightKind::directional;
  } else if (source.type != "point") {
    file.report(place + ".type",
                "'{:.40}': expected point, spot or directional: the lamp is left out", source.type);
    return std::nullopt;
  }
  light.intensity = light_color(file, source, place);
  if (is_black(light.intensity)) return std::nullopt;
  if (source.range > 0.0) file.report(place, "ranges of lights are ignored: they reach everywhere");
  return light;
}

}  // namespace

void add_lights(File& file, const std::vector<PlacedNode>& nodes, SceneData& scene) {
  for (const PlacedNode& node : nodes) {
    const auto& source = file.model.nodes[static_cast<std::size_t>(node.node)];
    const auto* extension = find_extension(source.extensions, "KHR_lights_punctual");
    if (!extension) continue;
    const int index = integer_or(*extension, "light", -1);
    if (!file.has(file.model.lights, index, "extensions.KHR_lights_punctual.lights",
                  node_place(node.node), "the node has no lamp")) {
      continue;
    }
    const tinygltf::Light& light = file.model.lights[static_cast<std::size_t>(index)];
    const std::string place = fmt::format("extensions.KHR_lights_punctual.lights[{}]", index);
    const std::optional<DeltaLight> made = make_light(file, light, node.to_world, place);
    if (!made) continue;
    if (!light.name.empty())
      scene.names.delta_lights[static_cast<std::uint32_t>(scene.delta_lights.size())] = light.name;
    scene.delta_lights.push_back(*made);
    scene.defaults.measure_exposure = true;
  }
}

}  // namespace pt::gltf
