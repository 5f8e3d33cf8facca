#include "common/scene/load/gltf/materials.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/scene/load/gltf/document/values.h"

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

/// Within [0, 1]; NaN becomes 0.
float unit(double x) { return x > 0.0 ? static_cast<float>(std::min(x, 1.0)) : 0.0f; }

/// What the components of textures are weighted by.
constexpr Color red(1, 0, 0), green(0, 1, 0), blue(0, 0, 1);

/// `bsdf`, with the opacity that was read already.
MaterialDescription with_surface_of(const MaterialDescription& before, MaterialDescription bsdf) {
  bsdf.opacity = before.opacity;
  return bsdf;
}

float extension_number(const tinygltf::Material& source, const char* extension, const char* key,
                       float fallback) {
  const auto* value = find_extension(source.extensions, extension);
  return value ? number_or(*value, key, fallback) : fallback;
}

}  // namespace

std::uint32_t Materials::material_index(int index, const std::string& place) {
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
    if (!source.name.empty()) scene_.names.materials[result] = source.name;
  }
  numbers_.emplace(index, result);
  return result;
}

bool Materials::is_unlit(int index) const {
  return index >= 0 &&
         find_extension(file_.model.materials[static_cast<std::size_t>(index)].extensions,
                        "KHR_materials_unlit");
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
    result.emission.texture = result.parameters[color_parameter].texture;
    result.parameters[color_parameter] = {};
    return result;
  }
  const auto* glossiness = find_extension(source.extensions, "KHR_materials_pbrSpecularGlossiness");
  if (glossiness) {
    set_specular_glossiness(*glossiness, place, result);
  } else {
    set_metallic_roughness(source, place, result);
  }
  set_emission(source, place, result);
  const bool passes = result.kind == kind_of<Principled> &&
                      !is_black(result.parameters[Principled::Index::spec_trans].value);
  result.one_sided = !passes && !source.doubleSided;
  return result;
}

void Materials::set_base(const tinygltf::Material& source, const std::string& place,
                         MaterialDescription& result) {
  const auto& pbr = source.pbrMetallicRoughness;
  result.parameters[color_parameter].value = clamped(to_color(pbr.baseColorFactor));
  if (const TextureUse use = texture_use(pbr.baseColorTexture)) {
    result.parameters[color_parameter].texture =
        textures_.add_color(use, place + ".pbrMetallicRoughness.baseColorTexture");
  }
}

Parameter Materials::number_of(float factor, const TextureUse& use, const std::string& place,
                               const Color& weights) {
  Parameter result{Color(factor), no_texture};
  if (use) result.texture = textures_.add_number(use, place, weights);
  return result;
}

void Materials::set_metallic_roughness(const tinygltf::Material& source, const std::string& place,
                                       MaterialDescription& result) {
  result = with_surface_of(result, describe_all<Principled>(0));
  set_base(source, place, result);
  const auto& pbr = source.pbrMetallicRoughness;
  const TextureUse use = texture_use(pbr.metallicRoughnessTexture);
  const std::string at = place + ".pbrMetallicRoughness.metallicRoughnessTexture";
  Parameter* p = result.parameters;
  p[Principled::Index::roughness] = number_of(unit(pbr.roughnessFactor), use, at, green);
  p[Principled::Index::metallic] = number_of(unit(pbr.metallicFactor), use, at, blue);
  set_transmission(source, place, result);
  set_index(source, place, result);
  set_sheen(source, place, result);
  set_clearcoat(source, place, result);
}

void Materials::set_specular_glossiness(const tinygltf::Value& source, const std::string& place,
                                        MaterialDescription& result) {
  file_.report(place, "KHR_materials_pbrSpecularGlossiness: diffuse in the diffuse colour is used");
  result.parameters[color_parameter].value =
      clamped(Color(vector_or(source, "diffuseFactor", Vec4(1.0f))));
  if (const TextureUse use = texture_use(member(source, "diffuseTexture"))) {
    result.parameters[color_parameter].texture = textures_.add_color(
        use, place + ".extensions.KHR_materials_pbrSpecularGlossiness.diffuseTexture");
  }
}

void Materials::set_transmission(const tinygltf::Material& source, const std::string& place,
                                 MaterialDescription& result) {
  const auto* extension = find_extension(source.extensions, "KHR_materials_transmission");
  if (!extension) return;
  const float transmission = unit(number_or(*extension, "transmissionFactor", 0.0f));
  if (transmission == 0.0f) return;
  file_.report(place, "KHR_materials_transmission: solid glass is used");
  result.parameters[Principled::Index::spec_trans] =
      number_of(transmission, texture_use(member(*extension, "transmissionTexture")),
                place + ".extensions.KHR_materials_transmission.transmissionTexture", red);
  set_volume(source, place, result);
}

/// What the colour leaves of light after the distance. The mesh itself says how thick it is: a
/// thickness of 0 means that it is a thin wall, and its texture is for renderers that trace no
/// rays.
void Materials::set_volume(const tinygltf::Material& source, const std::string& place,
                           MaterialDescription& result) {
  const auto* volume = find_extension(source.extensions, "KHR_materials_volume");
  if (!volume || !(number_or(*volume, "thicknessFactor", 0.0f) > 0.0f)) return;
  constexpr float endless = std::numeric_limits<float>::infinity();
  const float distance = number_or(*volume, "attenuationDistance", endless);
  if (!(distance > 0.0f)) {
    file_.fail(place + ".extensions.KHR_materials_volume.attenuationDistance",
               fmt::format("{}: expected > 0", distance));
  }
  constexpr float blackest = 1e-6f;  // of a colour; black would absorb everything at once
  const Color color = clamped(vector_or(*volume, "attenuationColor", Color(1.0f)));
  Medium medium;
  for (int c = 0; c < 3; ++c) {
    medium.extinction[c] = -std::log(std::max(color[c], blackest)) / distance;
  }
  if (is_black(medium.extinction)) return;
  if (scene_.media.size() >= no_medium) {
    file_.fail(place, fmt::format("expected at most {} media", no_medium));
  }
  result.is_boundary = true;
  result.media.inside = static_cast<std::uint16_t>(scene_.media.size());
  scene_.media.push_back(medium);
}

/// KHR_materials_ior, and KHR_materials_specular as another index with the reflectance that it
/// asks for.
void Materials::set_index(const tinygltf::Material& source, const std::string& place,
                          MaterialDescription& result) {
  float ior = extension_number(source, "KHR_materials_ior", "ior", 1.5f);
  if (!std::isfinite(ior) || ior < 1.0f) {
    file_.fail(place + ".extensions.KHR_materials_ior.ior", fmt::format("{}: expected >= 1", ior));
  }
  const bool passes = !is_black(result.parameters[Principled::Index::spec_trans].value);
  if (const auto* specular = find_extension(source.extensions, "KHR_materials_specular")) {
    const Color tint = vector_or(*specular, "specularColorFactor", Color(1.0f));
    if (passes || texture_use(member(*specular, "specularTexture")) ||
        texture_use(member(*specular, "specularColorTexture")) || tint != Color(tint.x)) {
      file_.report(place,
                   "KHR_materials_specular: its factor times the largest component of its colour "
                   "is used, without textures and not on what light passes");
    }
    const float factor = unit(number_or(*specular, "specularFactor", 1.0f)) * max_abs(tint);
    const float root = std::sqrt(std::min(normal_reflectance(ior) * factor, 0.99f));
    if (!passes) ior = (1.0f + root) / (1.0f - root);
  }
  // At 1 nothing would be reflected by metals, too, and nothing bent.
  result.parameters[Principled::Index::eta].value = Color(std::max(ior, 1.001f));
}

void Materials::set_sheen(const tinygltf::Material& source, const std::string& place,
                          MaterialDescription& result) {
  const auto* sheen = find_extension(source.extensions, "KHR_materials_sheen");
  if (!sheen) return;
  const Color color = clamped(vector_or(*sheen, "sheenColorFactor", Color(0.0f)));
  if (is_black(color)) return;
  file_.report(place,
               "KHR_materials_sheen: that of the principled BSDF is used, white and without "
               "roughness");
  result.parameters[Principled::Index::sheen] =
      number_of(max_abs(color), texture_use(member(*sheen, "sheenColorTexture")),
                place + ".extensions.KHR_materials_sheen.sheenColorTexture", Color(1.0f / 3.0f));
}

/// The gloss of the principled BSDF's coat goes from a roughness, alpha, of 0.1 to 0.001.
void Materials::set_clearcoat(const tinygltf::Material& source, const std::string& place,
                              MaterialDescription& result) {
  const auto* coat = find_extension(source.extensions, "KHR_materials_clearcoat");
  if (!coat) return;
  const float factor = unit(number_or(*coat, "clearcoatFactor", 0.0f));
  if (factor == 0.0f) return;
  file_.report(place, "KHR_materials_clearcoat: the coat of the principled BSDF is used");
  const std::string at = place + ".extensions.KHR_materials_clearcoat.";
  float roughness = unit(number_or(*coat, "clearcoatRoughnessFactor", 0.0f));
  if (const TextureUse use = texture_use(member(*coat, "clearcoatRoughnessTexture"))) {
    roughness *= textures_.mean(use, at + "clearcoatRoughnessTexture").y;
  }
  result.parameters[Principled::Index::clearcoat] = number_of(
      factor, texture_use(member(*coat, "clearcoatTexture")), at + "clearcoatTexture", red);
  result.parameters[Principled::Index::clearcoat_gloss].value =
      Color(unit((0.1f - roughness * roughness) / 0.099f));
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
  const std::uint32_t map = textures_.add_normals(use, place + ".normalTexture");
  if (map == no_texture) return scene_.add_material(material);
  MaterialDescription mapped =
      make_mapped(MaterialNode::gltf_normal_map, {{scale, 0.0f, 0.0f}, map}, 0);
  std::swap(mapped.emission, material.emission);
  std::swap(mapped.opacity, material.opacity);
  std::swap(mapped.is_boundary, material.is_boundary);
  std::swap(mapped.media, material.media);
  mapped.children[0] = mapped.children[1] = scene_.add_material(material);
  return scene_.add_material(mapped);
}

}  // namespace pt::gltf
