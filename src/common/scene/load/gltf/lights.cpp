#include "common/scene/load/gltf/lights.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/scene/load/gltf/document/values.h"

namespace pt::gltf {
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
    file.report_value(
        place + ".spot", "outerConeAngle",
        fmt::format("outerConeAngle {}: expected 0 < outerConeAngle <= pi / 2: {:.6g} "
                    "is used",
                    spot.outerConeAngle, outer));
  }
  if (!(inner >= 0.0 && inner <= spot.outerConeAngle)) {
    inner = std::clamp(inner, 0.0, outer);
    file.report_value(place + ".spot", "innerConeAngle",
                      fmt::format("innerConeAngle {}: expected 0 <= innerConeAngle <= "
                                  "outerConeAngle: {:.6g} is used",
                                  spot.innerConeAngle, inner));
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
                fmt::format("'{:.40}': expected point, spot or directional: the lamp is left out",
                            source.type));
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
