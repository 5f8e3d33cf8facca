#include "common/scene/prepare_materials.h"

#include "common/scene/weigh_textures.h"

namespace pt {
namespace {

/// How many of the description's parameters its BSDF has.
int parameter_count(const MaterialDescription& material) {
  return visit(material.kind, material, [](const auto& bsdf) { return bsdf.parameter_count; });
}

bool is_delta(const MaterialDescription& material) {
  return visit(material.kind, material, [](const auto& bsdf) { return bsdf.is_delta(); });
}

std::uint32_t size32(const auto& values) { return static_cast<std::uint32_t>(values.size()); }

Material pack(const MaterialDescription& source, SceneData& scene) {
  const Parameter* end = source.parameters + parameter_count(source);
  Material material;
  material.kind = source.kind;
  material.flags = static_cast<std::uint8_t>((source.one_sided ? Material::one_sided : 0) |
                                             (is_delta(source) ? Material::delta : 0) |
                                             (source.is_textured() ? Material::textured : 0));
  material.parameters = size32(scene.parameters);
  scene.parameters.insert(scene.parameters.end(), source.parameters + 1, end);
  if (!is_black(source.emission.radiance)) {
    material.emission = size32(scene.emissions);
    scene.emissions.push_back(source.emission);
  }
  return material;
}

}  // namespace

void prepare_materials(SceneData& scene) {
  weigh_emission_textures(scene);
  scene.material_records.clear(), scene.parameters.clear(), scene.emissions.clear();
  for (const MaterialDescription& m : scene.materials) scene.parameters.push_back(m.parameters[0]);
  for (const MaterialDescription& m : scene.materials) {
    scene.material_records.push_back(pack(m, scene));
  }
}

}  // namespace pt
