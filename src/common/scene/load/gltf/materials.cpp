#include "common/scene/load/gltf/materials.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/scene/load/files/importer.h"
#include "common/scene/load/gltf/document.h"

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

/// Whether light that enters goes through a solid; else the surface is an infinitely thin wall
/// (KHR_materials_transmission, KHR_materials_volume).
bool has_thickness(const tinygltf::Material& source) {
  const auto* volume = find_extension(source.extensions, "KHR_materials_volume");
  return volume && number_or(*volume, "thicknessFactor", 0.0f) > 0.0f;
}

float extension_number(const tinygltf::Material& source, const char* extension, const char* key,
                       float fallback) {
  const auto* value = find_extension(source.extensions, extension);
  return value ? number_or(*value, key, fallback) : fallback;
}

}  // namespace

std::uint32_t Materials::material_index(int index, const UvMaps& maps) {
  const auto known = numbers_.find({index, maps});
  if (known != numbers_.end()) return known->second;
  textures_.set_uv_maps(maps);
  std::uint32_t result;
  bool both_sides = false;
  if (index < 0) {
    result = add(tinygltf::Material(), "", both_sides);
  } else {
    const auto& source = file_.model.materials[static_cast<std::size_t>(index)];
    const std::string material_place = fmt::format(
        "materials[{}]{}", index, source.name.empty() ? "" : fmt::format(" '{:.60}'", source.name));
    result = add(source, material_place, both_sides);
    if (!source.name.empty()) scene_.names.materials[result] = source.name;
  }
  if (both_sides) two_sided_.insert(result);
  numbers_.emplace(std::pair(index, maps), result);
  return result;
}

bool Materials::is_unlit(int index) const {
  return index >= 0 &&
         find_extension(file_.model.materials[static_cast<std::size_t>(index)].extensions,
                        "KHR_materials_unlit");
}

MaterialDescription Materials::convert(const tinygltf::Material& source, const std::string& place,
                                       bool& both_sides) {
  MaterialDescription result;
  set_opacity(source, place, result);
  bool passes = false;
  if (find_extension(source.extensions, "KHR_materials_unlit")) {
    file_.report(
        place,
        "KHR_materials_unlit: black that emits the base colour is used, and lights the scene");
    set_base(source, place, result);
    result.emission.radiance = result.color(0);
    result.emission.texture = result.parameters[color_parameter].texture;
    result.parameters[color_parameter] = {};
  } else {
    const auto* glossiness =
        find_extension(source.extensions, "KHR_materials_pbrSpecularGlossiness");
    if (glossiness) {
      set_specular_glossiness(*glossiness, place, result);
      result.one_sided = !source.doubleSided;
    } else {
      passes = set_metallic_roughness(source, place, result);
    }
    set_emission(source, place, result);
  }
  both_sides = source.doubleSided && !is_black(result.emission.radiance) &&
               shine_on_both_sides(source, place, passes, result);
  return result;
}

/// A surface shines on the side of its normal, so that there will be two, one behind the other.
/// Where they are veils, both together must let through what one would, and show as much of what
/// they emit.
bool Materials::shine_on_both_sides(const tinygltf::Material& source, const std::string& place,
                                    bool passes, MaterialDescription& result) {
  if (passes) {
    file_.report(place, "doubleSided, emissive and transmissive: light from the front side only");
    return false;
  }
  Opacity& opacity = result.opacity;
  if (opacity.is_constant() && opacity.offset > 0.0f && opacity.offset < 1.0f) {
    const float both = opacity.offset;
    opacity.offset = 1.0f - std::sqrt(1.0f - both);
    result.emission.radiance *= both / opacity.offset;
  } else if (!opacity.is_constant() && opacity.cutoff == 0.0f) {
    const TextureUse base = texture_use(source.pbrMetallicRoughness.baseColorTexture);
    const std::string at = place + ".pbrMetallicRoughness.baseColorTexture";
    std::uint32_t& emission = result.emission.texture;
    const bool coloured = emission != no_texture;
    std::optional<Textures::Veil> veil;
    if (!coloured || emission == textures_.add_color(base, at)) {
      veil = textures_.add_veil(base, at, opacity.scale, coloured);
    }
    if (veil) {
      opacity = textured_opacity(1.0f, veil->opacity);
      emission = veil->emission;
    } else {
      file_.report(place,
                   "doubleSided, emissive and BLEND with different textures: two surfaces are "
                   "used, so that what is half transparent lets a quarter through");
    }
  }
  return true;
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

bool Materials::set_metallic_roughness(const tinygltf::Material& source, const std::string& place,
                                       MaterialDescription& result) {
  result = with_surface_of(result, make_material<Principled>(0));
  set_base(source, place, result);
  const auto& pbr = source.pbrMetallicRoughness;
  const TextureUse use = texture_use(pbr.metallicRoughnessTexture);
  const std::string at = place + ".pbrMetallicRoughness.metallicRoughnessTexture";
  result[&Principled::roughness] = number_of(unit(pbr.roughnessFactor), use, at, green);
  result[&Principled::metallic] = number_of(unit(pbr.metallicFactor), use, at, blue);
  const Parameter clear = transmission(source, place);
  bool passes = !is_black(clear.value);
  const bool is_thin = !has_thickness(source);
  const Base base = base_of(source, place, passes && !is_thin);
  result[&Principled::eta].value = Color(base.eta);
  const bool mirrors = !is_black(base.mirror);
  passes = passes && !mirrors;  // Fresnel's term is 1
  result.one_sided = !passes && !source.doubleSided;
  if (passes && !is_thin) {
    result[&Principled::spec_trans] = clear;
    set_volume(source, place, result);
  }
  set_sheen(source, place, result);
  set_clearcoat(source, place, result);
  if (mirrors) make_mirror(base.mirror, result);
  if (passes && is_thin) make_thin(clear, result);
  return passes;
}

std::uint32_t Materials::add_part(MaterialDescription part, float metallic) {
  part.opacity = {};
  if (part.kind == kind_of<Principled> && part.node == MaterialNode::none) {
    part[&Principled::metallic] = {Color(metallic), no_texture};
  }
  return scene_.add_material(part);
}

MaterialDescription Materials::with_metal(const MaterialDescription& principled,
                                          const MaterialDescription& base) {
  const Parameter& metallic = principled[&Principled::metallic];
  if (is_black(metallic.value)) return with_surface_of(principled, base);
  if (metallic.texture == no_texture && metallic.value.x >= 1.0f) return principled;
  // A base that mirrors is metal itself.
  const std::uint32_t below = add_part(base, base[&Principled::metallic].value.x);
  return with_surface_of(principled, make_blend(metallic, below, add_part(principled, 1.0f)));
}

void Materials::make_thin(const Parameter& clear, MaterialDescription& result) {
  MaterialDescription wall = make_material<PrincipledThin>(0);
  wall[&PrincipledThin::base_color] = result[&Principled::base_color];
  wall[&PrincipledThin::roughness] = result[&Principled::roughness];
  wall[&PrincipledThin::eta] = result[&Principled::eta];
  wall[&PrincipledThin::spec_trans].value = Color(1.0f);
  const Parameter& metallic = result[&Principled::metallic];
  if (clear.texture == no_texture && clear.value.x >= 1.0f) {
    result = with_metal(result, wall);
  } else if (clear.texture == no_texture && metallic.texture == no_texture) {
    // One blend: what is not clear has the metal's share of it.
    const float weight = clear.value.x * (1.0f - metallic.value.x);
    const std::uint32_t opaque = add_part(result, metallic.value.x / (1.0f - weight));
    result = with_surface_of(result,
                             make_blend({Color(weight), no_texture}, opaque, add_part(wall, 0.0f)));
  } else {
    const std::uint32_t opaque = add_part(result, 0.0f);
    result = with_metal(result, make_blend(clear, opaque, add_part(wall, 0.0f)));
  }
}

void Materials::make_mirror(const Color& reflectance, MaterialDescription& result) {
  const float weight = max_abs(reflectance);
  MaterialDescription mirror = result;
  mirror.parameters[color_parameter] = {reflectance / weight, no_texture};
  mirror[&Principled::metallic] = {Color(1.0f), no_texture};
  if (weight < 1.0f) {
    const std::uint32_t diffuse = add_part(result, 0.0f);
    mirror = make_blend({Color(weight), no_texture}, diffuse, add_part(mirror, 1.0f));
  }
  result = with_metal(result, mirror);
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

Parameter Materials::transmission(const tinygltf::Material& source, const std::string& place) {
  const auto* extension = find_extension(source.extensions, "KHR_materials_transmission");
  const float factor = extension ? unit(number_or(*extension, "transmissionFactor", 0.0f)) : 0.0f;
  if (factor == 0.0f) return {Color(0.0f), no_texture};
  return number_of(factor, texture_use(member(*extension, "transmissionTexture")),
                   place + ".extensions.KHR_materials_transmission.transmissionTexture", red);
}

/// What the colour leaves of light after the distance. The mesh itself says how thick it is; the
/// texture of thickness is for renderers that trace no rays.
void Materials::set_volume(const tinygltf::Material& source, const std::string& place,
                           MaterialDescription& result) {
  const auto* volume = find_extension(source.extensions, "KHR_materials_volume");
  if (!volume) return;
  constexpr float endless = std::numeric_limits<float>::infinity();
  const float distance = number_or(*volume, "attenuationDistance", endless);
  if (!(distance > 0.0f)) {
    file_.report_value(place + ".extensions.KHR_materials_volume.attenuationDistance",
                       "attenuationDistance", "{}: expected > 0: nothing is absorbed", distance);
    return;
  }
  constexpr float blackest = 1e-6f;  // of a colour; black would absorb everything at once
  const Color color = clamped(vector_or(*volume, "attenuationColor", Color(1.0f)));
  Medium medium;
  for (int c = 0; c < 3; ++c) {
    medium.extinction[c] = -std::log(std::max(color[c], blackest)) / distance;
  }
  if (is_black(medium.extinction)) return;
  if (scene_.media.size() >= no_medium) {
    file_.fail(place, "expected at most {} media", no_medium);
  }
  result.is_boundary = true;
  result.media.inside = static_cast<std::uint16_t>(scene_.media.size());
  scene_.media.push_back(medium);
}

/// KHR_materials_ior, and KHR_materials_specular as another index with the reflectance that it
/// asks for, where nothing is bent by it.
Materials::Base Materials::base_of(const tinygltf::Material& source, const std::string& place,
                                   bool bends) {
  float ior = extension_number(source, "KHR_materials_ior", "ior", 1.5f);
  if (!std::isfinite(ior) || (ior < 1.0f && ior != 0.0f)) {
    file_.report_value(place + ".extensions.KHR_materials_ior.ior", "ior",
                       "{}: expected 0 or a number >= 1: 1.5 is used", ior);
    ior = 1.5f;
  }
  // With an index of 0 all is reflected, for materials that were specular-glossiness.
  const float reflectance = ior == 0.0f ? 1.0f : normal_reflectance(ior);
  constexpr float mirror = 0.5f;  // no glass; the principled BSDF would not take it from the base
  Color hue(1.0f);
  float scale = 1.0f;
  if (const auto* specular = find_extension(source.extensions, "KHR_materials_specular")) {
    const Color tint = vector_or(*specular, "specularColorFactor", Color(1.0f));
    const bool is_coloured = tint != Color(tint.x) && reflectance <= mirror;
    if (bends || texture_use(member(*specular, "specularTexture")) ||
        texture_use(member(*specular, "specularColorTexture")) || is_coloured) {
      file_.report(place,
                   "KHR_materials_specular: its factor times the largest component of its colour "
                   "is used, without textures and not on what light passes");
    }
    const float factor = unit(number_or(*specular, "specularFactor", 1.0f)) * max_abs(tint);
    if (!bends && reflectance <= mirror) {
      ior = index_of_reflectance(std::min(reflectance * factor, 0.99f));
    }
    scale = factor;
    if (max_abs(tint) > 0.0f) hue = tint / max_abs(tint);
  }
  if (reflectance > mirror) return {1.001f, clamped(reflectance * scale * hue)};
  // At 1 nothing would be reflected by metals, too, and nothing bent.
  return {std::max(ior, 1.001f), Color(0.0f)};
}

void Materials::set_sheen(const tinygltf::Material& source, const std::string& place,
                          MaterialDescription& result) {
  const auto* sheen = find_extension(source.extensions, "KHR_materials_sheen");
  if (!sheen) return;
  const Color color = clamped(vector_or(*sheen, "sheenColorFactor", Color(0.0f)));
  if (is_black(color)) return;
  file_.report(
      place,
      "KHR_materials_sheen: that of the principled BSDF is used, white and without roughness");
  result[&Principled::sheen] =
      number_of(max_abs(color), texture_use(member(*sheen, "sheenColorTexture")),
                place + ".extensions.KHR_materials_sheen.sheenColorTexture", Color(1.0f / 3.0f));
}

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
  result[&Principled::clearcoat] = number_of(factor, texture_use(member(*coat, "clearcoatTexture")),
                                             at + "clearcoatTexture", red);
  result[&Principled::clearcoat_gloss].value = Color(gloss_of_coat(roughness));
}

void Materials::set_emission(const tinygltf::Material& source, const std::string& place,
                             MaterialDescription& result) {
  if (source.emissiveFactor.size() != 3) return;  // the default material
  const float strength =
      extension_number(source, "KHR_materials_emissive_strength", "emissiveStrength", 1.0f);
  const Color emission = strength * to_color(source.emissiveFactor);
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(emission[i]) || emission[i] < 0.0f) {
      file_.report(place + ".emissiveFactor", "expected finite numbers >= 0: nothing is emitted");
      return;
    }
  }
  result.emission.radiance = emission;
  if (is_black(emission)) return;
  if (const TextureUse use = texture_use(source.emissiveTexture)) {
    result.emission.texture = textures_.add_color(use, place + ".emissiveTexture");
  }
}

void Materials::set_opacity(const tinygltf::Material& source, const std::string& place,
                            MaterialDescription& result) {
  if (source.alphaMode != "MASK" && source.alphaMode != "BLEND") {
    if (!source.alphaMode.empty() && source.alphaMode != "OPAQUE") {
      file_.report(place + ".alphaMode", "'{:.40}': expected OPAQUE, MASK or BLEND: OPAQUE is used",
                   source.alphaMode);
    }
    return;
  }
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

void Materials::read_ahead() const {
  for (const tinygltf::Material& source : file_.model.materials) {
    const auto& pbr = source.pbrMetallicRoughness;
    textures_.read_ahead(texture_use(pbr.baseColorTexture), TextureFormat::srgb8);
    textures_.read_ahead(texture_use(pbr.metallicRoughnessTexture), TextureFormat::linear8);
    textures_.read_ahead(texture_use(source.emissiveTexture), TextureFormat::srgb8);
    textures_.read_ahead(texture_use(source.normalTexture), TextureFormat::linear8);
  }
}

std::uint32_t Materials::add(const tinygltf::Material& source, const std::string& place,
                             bool& both_sides) {
  MaterialDescription material = convert(source, place, both_sides);
  const TextureUse use = texture_use(source.normalTexture);
  if (!use) return scene_.add_material(material);
  const auto scale = static_cast<float>(source.normalTexture.scale);
  const std::uint32_t map = textures_.add_normals(use, place + ".normalTexture");
  if (map == no_texture) return scene_.add_material(material);
  return scene_.add_material(
      under_map(MaterialNode::gltf_normal_map, {{scale, 0.0f, 0.0f}, map}, material,
                [&](const MaterialDescription& inside) { return scene_.add_material(inside); }));
}

}  // namespace pt::gltf
