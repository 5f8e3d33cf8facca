// Materials of pbrt-v4: glass and blends; diffuse ones, bare and coated; metals.
#include <algorithm>
#include <cmath>

#include "common/scene/data/plastic_material.h"
#include "common/scene/load/pbrt/surfaces/surfaces.h"
#include "common/scene/load/pbrt/surfaces/textures.h"
#include "common/scene/load/pbrt/syntax/parameters.h"

namespace pt::pbrt {

Surface read_dielectric(Context& context, const Parameters& parameters) {
  const float eta = read_index(context, parameters, "eta", 1.5f);
  const Roughness roughness = read_roughness(context, parameters);
  Surface surface;
  if (roughness.is_smooth()) {
    surface.material = make_dielectric(Color(1.0f), eta);
  } else {
    surface.material = make_material<RoughDielectric>(1.0f, 1.0f, eta);
    roughness.store(&surface.material[&RoughDielectric::alpha_x]);
  }
  return surface;
}

Surface read_thin_dielectric(Context& context, const Parameters& parameters) {
  Surface surface;
  surface.material =
      make_material<ThinDielectric>(1.0f, 1.0f, read_index(context, parameters, "eta", 1.5f));
  return surface;
}

Surface blend(Context& context, const ColorTexture& weight, const Surface& first,
              const Surface& second) {
  if (weight.is_constant() && weight.color.x <= 0.0f) return first;
  if (weight.is_constant() && weight.color.x >= 1.0f) return second;
  Surface result;
  result.material = make_blend(parameter_of(weight), context.add_material(first.material),
                               context.add_material(second.material));
  return result;
}

/// 'amount' is the share of the second one; that of the first in pbrt-v3, where it may be a colour.
Surface read_mix_material(Context& context, const Parameters& parameters) {
  std::vector<std::string> names = parameters.texts("materials");
  const bool is_earlier = names.empty() && parameters.find("namedmaterial1");
  if (is_earlier) {
    names = {parameters.text("namedmaterial2", ""), parameters.text("namedmaterial1", "")};
  }
  if (names.size() != 2) {
    fail(parameters.place(), "mix: {} names in 'string materials'; expected 2", names.size());
  }
  const Parameter* given = parameters.find("amount");
  ColorTexture amount;
  if (is_earlier && given && given->type != "float") {
    amount = read_color_texture(context, parameters, "amount", Color(0.5f));
    if (amount.is_constant()) amount.color = Color(mean(amount.color));
  } else {
    amount = read_number_texture(context, parameters, "amount", 0.5f);
  }
  const Surface first = read_surface(context, names[0], parameters.place());
  const Surface second = read_surface(context, names[1], parameters.place());
  if (first.invisible || second.invisible) {
    fail(parameters.place(), "mix: expected two materials, of which none is 'interface'");
  }
  return blend(context, amount, first, second);
}

namespace {

// Surfaces that scatter light in all directions, bare and coated, and what stands in for those that
// do so below the surface.

void report_anisotropy(Context& context, const Parameters& parameters, const Roughness& roughness) {
  if (roughness.alpha_u.color == roughness.alpha_v.color &&
      roughness.alpha_u.texture == roughness.alpha_v.texture) {
    return;
  }
  context.reporter.warn_once("anisotropic coat", parameters.place(),
                             "an anisotropic coat is not supported: uroughness is used for both");
}

float largest(const ColorTexture& value) {
  return std::max({value.color.x, value.color.y, value.color.z, 0.0f});
}

}  // namespace

/// A boundary of facets over a diffuse body that colours each internal reflection: pbrt's layers
/// without anything in between, whose light it finds by random walks.
Surface coated(const ColorTexture& body, float eta, const Roughness& roughness) {
  const PlasticCoat coat{eta, true};
  const float alpha = std::max(roughness.alpha_u.color.x, 0.0f);
  Surface surface;
  if (roughness.is_smooth()) {
    surface.material = make_plastic(Color(0.0f), Color(1.0f), coat);
  } else {
    surface.material =
        make_rough_plastic(Color(0.0f), Color(1.0f), coat, std::clamp(alpha, 1e-3f, 1.0f), false);
    surface.material[&RoughPlastic::alpha].texture = roughness.alpha_u.texture;
  }
  surface.material.parameters[color_parameter] = parameter_of(body);
  return surface;
}

Surface read_diffuse(Context& context, const Parameters& parameters) {
  Surface surface;
  surface.material[&Diffuse::albedo] =
      parameter_of(read_color_texture(context, parameters, "reflectance", Color(0.5f)));
  return surface;
}

Surface read_coated_diffuse(Context& context, const Parameters& parameters) {
  const ColorTexture albedo = read_color_texture(context, parameters, "albedo", Color(0.0f));
  if (!albedo.is_constant() || !is_black(albedo.color)) {
    context.reporter.warn_once(
        "coat medium", parameters.place(),
        "a medium in a coat ('albedo', 'g') is not supported: the coat is clear");
  }
  parameters.ignore({"maxdepth", "nsamples", "g"});
  const Roughness roughness = read_roughness(context, parameters);
  report_anisotropy(context, parameters, roughness);
  const ColorTexture body = read_color_texture(context, parameters, "reflectance", Color(0.5f));
  // A coat absorbs exp(-thickness / cos) on each way, whatever its medium. 3 thicknesses are
  // between the length of light's way to the body and out again, and that of all directions' mean.
  return coated(scaled(body, std::exp(-3.0f * read_thickness(context, parameters))),
                read_index(context, parameters, "eta", 1.5f), roughness);
}

/// A blend of a surface that reflects and one that lets pass, each with its colour over its share.
Surface diffuse_both_ways(Context& context, const ColorTexture& reflected,
                          const ColorTexture& passed) {
  const float r = largest(reflected), t = largest(passed);
  const float share = t > 0.0f ? t / (r + t) : 0.0f;
  Surface front, through;
  front.material[&Diffuse::albedo] =
      parameter_of(scaled(reflected, share < 1.0f ? 1.0f / (1.0f - share) : 0.0f));
  through.material = make_material<PrincipledThin>(0, 0.5f, 0, 1.0f);
  through.material[&PrincipledThin::base_color] =
      parameter_of(scaled(passed, share > 0.0f ? 1.0f / share : 0.0f));
  through.material[&PrincipledThin::diff_trans].value = Color(2.0f);
  return blend(context, {Color(share)}, front, through);
}

Surface read_diffuse_transmission(Context& context, const Parameters& parameters) {
  const float scale = parameters.number("scale", 1.0f);
  return diffuse_both_ways(
      context, scaled(read_color_texture(context, parameters, "reflectance", Color(0.25f)), scale),
      scaled(read_color_texture(context, parameters, "transmittance", Color(0.25f)), scale));
}

Surface read_subsurface(Context& context, const Parameters& parameters) {
  report_replaced(context, parameters,
                  "a coated diffuse surface of its 'reflectance' (or 0.7) is used");
  const ColorTexture body = read_color_texture(context, parameters, "reflectance", Color(0.7f));
  const float eta = parameters.number("eta", 1.33f);
  const Roughness roughness = read_roughness(context, parameters);
  parameters.ignore_all();
  if (!(eta > 0.0f)) fail(parameters.place(), "subsurface: expected an 'eta' above 0");
  return coated(body, eta, roughness);
}

Surface read_hair(Context& context, const Parameters& parameters) {
  report_replaced(context, parameters, "a diffuse surface of its colour (or brown) is used");
  const char* name = parameters.find("color") ? "color" : "reflectance";
  Surface surface;
  surface.material[&Diffuse::albedo] =
      parameter_of(read_color_texture(context, parameters, name, Color(0.25f, 0.12f, 0.06f)));
  parameters.ignore_all();
  return surface;
}

namespace {

// Conductors, bare and coated, and the roughness that metals and glass have.

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
      fail(parameters.place(),
           "{} has a 'reflectance' besides '{}' or '{}'; expected the one or the others",
           parameters.what(), eta_name, k_name);
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
  surface.material = make_material<Conductor>(1.0f);
  surface.material[&Conductor::eta] = parameter_of(eta);
  surface.material[&Conductor::k] = parameter_of(k);
  if (!roughness.is_smooth()) roughness.store(&surface.material[&Conductor::alpha_x]);
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
      fail(parameters.place(), "{}: a '{}' of {}; expected one that is not negative",
           parameters.what(), name, value.color.x);
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
  fail(parameters.place(), "{}: a thickness below 0", parameters.what());
}

Surface read_conductor(Context& context, const Parameters& parameters) {
  const MetalIndex metal = read_metal_index(context, parameters, "", 1.0f);
  return conductor_of(metal.eta, metal.k, read_roughness(context, parameters));
}

/// A blend of the coat's reflection and the metal's below it. Along the normal the sum is right,
/// also of what is reflected to and fro and absorbed on its way: F + (1 - F)^2 R / (1 - F R).
Surface read_coated_conductor(Context& context, const Parameters& parameters) {
  report_replaced(
      context, parameters,
      "a blend of its metal and a mirror that reflects as its coat along the normal is used");
  parameters.ignore({"maxdepth", "nsamples", "g", "albedo"});
  const float eta = read_index(context, parameters, "interface.eta", 1.5f);
  const MetalIndex metal = read_metal_index(context, parameters, "conductor.", eta);
  const float F = fresnel_dielectric(1.0f, eta);
  Surface below =
      conductor_of(metal.eta, metal.k, read_roughness(context, parameters, "conductor."));
  const float T = std::exp(-2.0f * read_thickness(context, parameters));
  const Color R = T * fresnel_conductor(1.0f, metal.eta.color, metal.k.color);
  below.material[&Conductor::tint].value = T * Color(1.0f - F) / (Color(1.0f) - F * R);
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
