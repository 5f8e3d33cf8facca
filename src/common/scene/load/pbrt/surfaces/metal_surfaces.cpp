// Conductors, bare and coated, and the roughness that metals and glass have.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/scene/load/pbrt/colors/named_spectra.h"
#include "common/scene/load/pbrt/surfaces/surface_kinds.h"
#include "common/scene/load/pbrt/textures/bake.h"

namespace pt::pbrt {
namespace {

float root(float roughness) { return std::sqrt(std::max(roughness, 0.0f)); }

/// pbrt-v3's (TrowbridgeReitzDistribution::RoughnessToAlpha).
float polynomial(float roughness) {
  const float x = std::log(std::max(roughness, 1e-3f));
  return 1.62142f + x * (0.819955f + x * (0.1734f + x * (0.0171201f + x * 0.000640711f)));
}

/// pbrt's remapping of roughness; a texture is remapped texel by texel.
ColorTexture remapped(Context& context, const ColorTexture& roughness, float (*map)(float)) {
  const auto each = [map](const std::vector<Color>& v) {
    return Color(map(v[0].x), map(v[0].y), map(v[0].z));
  };
  return bake(context, {roughness}, each);
}

/// eta and k over the index `outside`.
struct MetalIndex {
  ColorTexture eta, k;
};

/// pbrt's metal of a reflectance along the normal: eta = 1 and k = 2 sqrt(r / (1 - r)).
MetalIndex index_of_reflectance(Context& context, const ColorTexture& reflectance, float outside) {
  const auto absorption = [outside](const std::vector<Color>& v) {
    const Color r = glm::clamp(v[0], Color(0.0f), Color(0.9999f));
    return 2.0f * glm::sqrt(r / (Color(1.0f) - r)) / outside;
  };
  return {{Color(1.0f / outside)}, bake(context, {reflectance}, absorption)};
}

MetalIndex read_metal_index(Context& context, const Parameters& parameters,
                            const std::string& prefix, float outside) {
  const std::string eta_name = prefix + "eta", k_name = prefix + "k";
  if (parameters.find("reflectance")) {
    if (parameters.find(eta_name) || parameters.find(k_name)) {
      fail(parameters.place(), fmt::format("{} has a 'reflectance' besides '{}' or '{}'; expected "
                                           "the one or the others",
                                           parameters.what(), eta_name, k_name));
    }
    return index_of_reflectance(
        context, read_color_texture(context, parameters, "reflectance", Color(0.0f)), outside);
  }
  MetalIndex metal{read_color_texture(context, parameters, eta_name, *named_metal("metal-Cu-eta"),
                                      Quantity::unbounded),
                   read_color_texture(context, parameters, k_name, *named_metal("metal-Cu-k"),
                                      Quantity::unbounded)};
  metal.eta.color /= outside, metal.k.color /= outside;
  return metal;
}

}  // namespace

Surface conductor_of(const ColorTexture& eta, const ColorTexture& k, const Roughness& roughness) {
  Surface surface;
  surface.material = describe_all<Conductor>(1.0f);
  using Index = Conductor::Index;
  surface.material.parameters[Index::eta] = parameter_of(eta);
  surface.material.parameters[Index::k] = parameter_of(k);
  if (!roughness.is_smooth()) roughness.store(surface.material.parameters + Index::alpha_x);
  return surface;
}

void Roughness::store(pt::Parameter* parameters) const {
  parameters[0] = parameter_of(alpha_u);
  parameters[1] = parameter_of(alpha_v);
  for (int i = 0; i < 2; ++i) {
    if (parameters[i].texture == no_texture) {
      parameters[i].value = glm::max(parameters[i].value, Color(Microfacets::alpha_min));
    }
  }
}

Roughness read_roughness(Context& context, const Parameters& parameters, const std::string& prefix,
                         float fallback, bool is_earlier) {
  const bool remaps = parameters.boolean("remaproughness", true);
  const auto read = [&](const std::string& name) {
    const ColorTexture value = read_number_texture(context, parameters, name, fallback);
    if (value.is_constant() && !(value.color.x >= 0.0f)) {
      fail(parameters.place(), fmt::format("{}: a '{}' of {}; expected one that is not negative",
                                           parameters.what(), name, value.color.x));
    }
    return remaps ? remapped(context, value, is_earlier ? polynomial : root) : value;
  };
  const ColorTexture both = read(prefix + "roughness");
  const auto along = [&](const std::string& own) {
    return parameters.find(own) ? read(own) : both;
  };
  return {along(prefix + "uroughness"), along(prefix + "vroughness")};
}

float read_thickness(Context& context, const Parameters& parameters) {
  const float thickness = read_plain_number(context, parameters, "thickness", 0.01f);
  if (thickness >= 0.0f) return thickness;
  fail(parameters.place(), fmt::format("{}: a thickness below 0", parameters.what()));
}

Surface read_conductor(Context& context, const Parameters& parameters) {
  const MetalIndex metal = read_metal_index(context, parameters, "", 1.0f);
  return conductor_of(metal.eta, metal.k, read_roughness(context, parameters));
}

/// A blend of the coat's reflection and the metal's below it. Along the normal the sum is right,
/// also of what is reflected to and fro and absorbed on its way: F + (1 - F)^2 R / (1 - F R).
Surface read_coated_conductor(Context& context, const Parameters& parameters) {
  report_replaced(context, parameters,
                  "a blend of its metal and a mirror that reflects as its coat along the normal is "
                  "used");
  parameters.ignore({"maxdepth", "nsamples", "g", "albedo"});
  const float eta = read_index(context, parameters, "interface.eta", 1.5f);
  const MetalIndex metal = read_metal_index(context, parameters, "conductor.", eta);
  const float F = fresnel_dielectric(1.0f, eta);
  Surface below =
      conductor_of(metal.eta, metal.k, read_roughness(context, parameters, "conductor."));
  const float T = std::exp(-2.0f * read_thickness(context, parameters));
  const Color R = T * fresnel_conductor(1.0f, metal.eta.color, metal.k.color);
  below.material.parameters[Conductor::Index::tint].value =
      T * Color(1.0f - F) / (Color(1.0f) - F * R);
  // eta 0 and k 1 reflect everything.
  const Surface coat =
      conductor_of({Color(0.0f)}, {Color(1.0f)}, read_roughness(context, parameters, "interface."));
  return blend(context, {Color(F)}, below, coat);
}

Surface read_measured(Context& context, const Parameters& parameters) {
  report_replaced(context, parameters, "a rough metal that reflects one half is used");
  parameters.ignore_all();
  const MetalIndex grey = index_of_reflectance(context, {Color(0.5f)}, 1.0f);
  return conductor_of(grey.eta, grey.k, {{Color(0.3f)}, {Color(0.3f)}});
}

}  // namespace pt::pbrt
