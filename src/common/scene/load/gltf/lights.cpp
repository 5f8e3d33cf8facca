#include "common/scene/load/gltf/lights.h"

#include "common/scene/load/gltf/document/values.h"

namespace pt::gltf {

namespace {

Color light_color(const File& file, const tinygltf::Light& source, const std::string& place) {
  Color color(1.0f);
  if (!source.color.empty() && source.color.size() != 3) {
    file.fail(place + ".color", "expected three numbers");
  }
  for (std::size_t i = 0; i < source.color.size(); ++i) {
    color[static_cast<int>(i)] = static_cast<float>(source.color[i]);
  }
  color *= static_cast<float>(source.intensity);
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(color[i]) || color[i] < 0.0f) {
      file.fail(place, "expected a finite color and intensity >= 0");
    }
  }
  return color;
}

void set_cone(const File& file, const tinygltf::SpotLight& spot, const std::string& place,
              DeltaLight& light) {
  const double inner = spot.innerConeAngle, outer = spot.outerConeAngle;
  if (!(inner >= 0.0 && inner < outer && outer <= 1.5708)) {
    file.fail(place + ".spot", fmt::format("innerConeAngle {} and outerConeAngle {}: expected 0 <= "
                                           "inner < outer <= pi / 2",
                                           inner, outer));
  }
  light.cos_inner = static_cast<float>(std::cos(inner));
  light.cos_outer = static_cast<float>(std::cos(outer));
}

DeltaLight make_light(File& file, const tinygltf::Light& source, const Affine& to_world,
                      const std::string& place) {
  DeltaLight light;
  light.position = to_world.translation();
  const Vec3 direction = to_world.vector({0, 0, -1});
  if (source.type == "spot" || source.type == "directional") {
    if (!(glm::length(direction) > 0.0f)) file.fail(place, "its node's transformation is singular");
    light.direction = normalize(direction);
  }
  if (source.type == "spot") {
    light.kind = LightKind::spot;
    light.falloff = SpotFalloff::square_cosine;
    set_cone(file, source.spot, place, light);
  } else if (source.type == "directional") {
    light.kind = LightKind::directional;
  } else if (source.type != "point") {
    file.fail(place + ".type",
              fmt::format("'{:.40}': expected point, spot or directional", source.type));
  }
  light.intensity = light_color(file, source, place);
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
    const auto& light = file.at(file.model.lights, index, "extensions.KHR_lights_punctual.lights",
                                node_place(node.node));
    const std::string place = fmt::format("extensions.KHR_lights_punctual.lights[{}]", index);
    const DeltaLight made = make_light(file, light, node.to_world, place);
    if (is_black(made.intensity)) continue;
    if (!light.name.empty())
      scene.names.delta_lights[static_cast<std::uint32_t>(scene.delta_lights.size())] = light.name;
    scene.delta_lights.push_back(made);
    scene.defaults.measure_exposure = true;
  }
}

}  // namespace pt::gltf
