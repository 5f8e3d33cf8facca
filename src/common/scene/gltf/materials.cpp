#include "common/scene/gltf/materials.h"

#include <algorithm>
#include <utility>

#include "common/scene/gltf/values.h"

namespace pt::gltf {

namespace {

/// As reflectance: within [0, 1]. NaN becomes 0.
Color clamped(const Color& c) {
  const auto clamp = [](float x) { return x > 0.0f ? std::min(x, 1.0f) : 0.0f; };
  return {clamp(c.x), clamp(c.y), clamp(c.z)};
}

Color to_color(const std::vector<double>& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

float extension_number(const tinygltf::Material& source, const char* extension, const char* key,
                       float fallback) {
  const auto* value = find_extension(source.extensions, extension);
  return value ? number_or(*value, key, fallback) : fallback;
}

}  // namespace

std::uint32_t Materials::number(int index, const std::string& place) {
  const auto known = numbers_.find(index);
  if (known != numbers_.end()) return known->second;
  std::uint32_t result;
  if (index < 0) {
    result = add(tinygltf::Material(), place);
  } else {
    const auto& source = file_.at(file_.model.materials, index, "materials", place + ".material");
    const std::string material_place = fmt::format(
        "materials[{}]{}", index, source.name.empty() ? "" : fmt::format(" '{:.60}'", source.name));
    result = add(source, material_place);
  }
  numbers_.emplace(index, result);
  return result;
}

MaterialDescription Materials::convert(const tinygltf::Material& source, const std::string& place) {
  MaterialDescription result;
  set_opacity(source, place, result);
  if (find_extension(source.extensions, "KHR_materials_unlit")) {
    file_.report(place,
                 "KHR_materials_unlit: black that emits the base colour is used, and lights "
                 "the scene");
    set_base(source, place, result);
    result.emission.radiance = result.color(0);
    result.emission.texture = result.parameters[0].texture;
    result.parameters[0] = {};
    return result;
  }
  const auto* glossiness = find_extension(source.extensions, "KHR_materials_pbrSpecularGlossiness");
  if (glossiness) {
    set_specular_glossiness(*glossiness, place, result);
  } else if (!set_transmission(source, place, result)) {
    set_metallic_roughness(source, place, result);
  }
  set_emission(source, place, result);
  result.one_sided = result.kind == kind_of<Diffuse> && !source.doubleSided;
  return result;
}

void Materials::set_base(const tinygltf::Material& source, const std::string& place,
                         MaterialDescription& result) {
  const auto& pbr = source.pbrMetallicRoughness;
  result.parameters[0].value = clamped(to_color(pbr.baseColorFactor));
  if (const TextureUse use = texture_use(pbr.baseColorTexture)) {
    result.parameters[0].texture =
        textures_.add_color(use, place + ".pbrMetallicRoughness.baseColorTexture");
  }
}

void Materials::set_metallic_roughness(const tinygltf::Material& source, const std::string& place,
                                       MaterialDescription& result) {
  set_base(source, place, result);
  const auto& pbr = source.pbrMetallicRoughness;
  auto metallic = static_cast<float>(pbr.metallicFactor);
  auto roughness = static_cast<float>(pbr.roughnessFactor);
  if (const TextureUse use = texture_use(pbr.metallicRoughnessTexture)) {
    const std::string texture_place = place + ".pbrMetallicRoughness.metallicRoughnessTexture";
    file_.report(texture_place, "textures of metallic and roughness: their means are used");
    const Color mean = textures_.mean(use, texture_place);
    roughness *= mean.y;
    metallic *= mean.z;
  }
  if (metallic >= 0.5f) {
    file_.report(place,
                 "metallic >= 0.5: metal in the base colour is used, its fuzz is roughness "
                 "squared");
    result.kind = kind_of<Metal>;
    result.parameters[1].value = Color(std::clamp(roughness * roughness, 0.0f, 1.0f));
  } else {
    file_.report(place,
                 "metallic < 0.5: diffuse in the base colour is used, without a specular "
                 "coat");
  }
}

void Materials::set_specular_glossiness(const tinygltf::Value& source, const std::string& place,
                                        MaterialDescription& result) {
  file_.report(place, "KHR_materials_pbrSpecularGlossiness: diffuse in the diffuse colour is used");
  result.parameters[0].value = clamped(Color(vector_or(source, "diffuseFactor", Vec4(1.0f))));
  if (const TextureUse use = texture_use(member(source, "diffuseTexture"))) {
    result.parameters[0].texture = textures_.add_color(
        use, place + ".extensions.KHR_materials_pbrSpecularGlossiness.diffuseTexture");
  }
}

bool Materials::set_transmission(const tinygltf::Material& source, const std::string& place,
                                 MaterialDescription& result) {
  const auto* extension = find_extension(source.extensions, "KHR_materials_transmission");
  float transmission = extension ? number_or(*extension, "transmissionFactor", 0.0f) : 0.0f;
  if (!(transmission > 0.0f)) return false;
  if (const TextureUse use = texture_use(member(*extension, "transmissionTexture"))) {
    const std::string texture_place =
        place + ".extensions.KHR_materials_transmission.transmissionTexture";
    file_.report(texture_place, "textures of transmission: their means are used");
    transmission *= textures_.mean(use, texture_place).x;
  }
  if (!(transmission > 0.5f)) {
    file_.report(place, "transmission <= 0.5 is ignored");
    return false;
  }
  file_.report(place, "transmission > 0.5: smooth, solid glass in the base colour is used");
  set_base(source, place, result);
  const float ior = extension_number(source, "KHR_materials_ior", "ior", 1.5f);
  if (!std::isfinite(ior) || ior < 1.0f) {
    file_.fail(place + ".extensions.KHR_materials_ior.ior", fmt::format("{}: expected >= 1", ior));
  }
  result.kind = kind_of<Dielectric>;
  result.parameters[1].value = Color(ior);
  return true;
}

void Materials::set_emission(const tinygltf::Material& source, const std::string& place,
                             MaterialDescription& result) {
  if (source.emissiveFactor.size() != 3) return;  // the default material
  const float strength =
      extension_number(source, "KHR_materials_emissive_strength", "emissiveStrength", 1.0f);
  const Color emission = strength * to_color(source.emissiveFactor);
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(emission[i]) || emission[i] < 0.0f) {
      file_.fail(place + ".emissiveFactor", "expected finite numbers >= 0");
    }
  }
  result.emission.radiance = emission;
  if (is_black(emission)) return;
  if (source.doubleSided) {
    file_.report(place, "doubleSided and emissive: light from the front side only");
  }
  if (const TextureUse use = texture_use(source.emissiveTexture)) {
    result.emission.texture = textures_.add_color(use, place + ".emissiveTexture");
  }
}

void Materials::set_opacity(const tinygltf::Material& source, const std::string& place,
                            MaterialDescription& result) {
  if (source.alphaMode != "MASK" && source.alphaMode != "BLEND") return;
  const auto& pbr = source.pbrMetallicRoughness;
  const auto factor = static_cast<float>(pbr.baseColorFactor[3]);
  std::uint32_t alpha = no_texture;
  if (const TextureUse use = texture_use(pbr.baseColorTexture)) {
    alpha = textures_.add_alpha(use, place + ".pbrMetallicRoughness.baseColorTexture");
  }
  const bool cuts = source.alphaMode == "MASK";
  const auto cutoff = static_cast<float>(source.alphaCutoff);
  if (alpha != no_texture) {
    // A cutoff of 0 keeps everything.
    if (!cuts || cutoff > 0.0f) result.opacity = textured_opacity(factor, alpha, cuts ? cutoff : 0);
  } else {
    result.opacity = constant_opacity(!cuts ? factor : factor >= cutoff ? 1.0f : 0.0f);
  }
}

std::uint32_t Materials::add(const tinygltf::Material& source, const std::string& place) {
  MaterialDescription material = convert(source, place);
  TextureUse use{source.normalTexture.index, source.normalTexture.texCoord, {}};
  if (!use) return scene_.add_material(material);
  if (const auto* transform =
          find_extension(source.normalTexture.extensions, "KHR_texture_transform")) {
    use.transform = *transform;
  }
  const auto scale = static_cast<float>(source.normalTexture.scale);
  const std::uint32_t map = textures_.add_linear(use, place + ".normalTexture");
  MaterialDescription mapped =
      make_mapped(MaterialNode::gltf_normal_map, {{scale, 0.0f, 0.0f}, map}, 0);
  std::swap(mapped.emission, material.emission);
  std::swap(mapped.opacity, material.opacity);
  mapped.children[0] = mapped.children[1] = scene_.add_material(material);
  return scene_.add_material(mapped);
}

}  // namespace pt::gltf
