// Surfaces that scatter light in all directions, bare and coated, and what stands in for those that
// do so below the surface.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/scene/data/plastic_material.h"
#include "common/scene/load/pbrt/surfaces/surface_kinds.h"

namespace pt::pbrt {
namespace {

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
    surface.material.parameters[RoughPlastic::Index::alpha].texture = roughness.alpha_u.texture;
  }
  surface.material.parameters[color_parameter] = parameter_of(body);
  return surface;
}

Surface read_diffuse(Context& context, const Parameters& parameters) {
  Surface surface;
  surface.material.parameters[Diffuse::Index::albedo] =
      parameter_of(read_color_texture(context, parameters, "reflectance", Color(0.5f)));
  return surface;
}

Surface read_coated_diffuse(Context& context, const Parameters& parameters) {
  const ColorTexture albedo = read_color_texture(context, parameters, "albedo", Color(0.0f));
  if (!albedo.is_constant() || !is_black(albedo.color)) {
    context.reporter.warn_once("coat medium", parameters.place(),
                               "a medium in a coat ('albedo', 'g') is not supported: the coat is "
                               "clear");
  }
  parameters.ignore({"maxdepth", "nsamples", "g"});
  const Roughness roughness = read_roughness(context, parameters);
  report_anisotropy(context, parameters, roughness);
  const ColorTexture body = read_color_texture(context, parameters, "reflectance", Color(0.5f));
  // A coat absorbs exp(-thickness / cos) on each way, whatever its medium. Between what light on
  // its way out meets and the mean of all directions, ways to the body and back are 3 thicknesses
  // long.
  return coated(scaled(body, std::exp(-3.0f * read_thickness(context, parameters))),
                read_index(context, parameters, "eta", 1.5f), roughness);
}

/// A blend of a surface that reflects and one that lets pass, each with its colour over its share.
Surface diffuse_both_ways(Context& context, const ColorTexture& reflected,
                          const ColorTexture& passed) {
  const float r = largest(reflected), t = largest(passed);
  const float share = t > 0.0f ? t / (r + t) : 0.0f;
  Surface front, through;
  front.material.parameters[Diffuse::Index::albedo] =
      parameter_of(scaled(reflected, share < 1.0f ? 1.0f / (1.0f - share) : 0.0f));
  through.material = describe_all<PrincipledThin>(0, 0.5f, 0, 1.0f);
  using Index = PrincipledThin::Index;
  through.material.parameters[Index::base_color] =
      parameter_of(scaled(passed, share > 0.0f ? 1.0f / share : 0.0f));
  through.material.parameters[Index::diff_trans].value = Color(2.0f);
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
  surface.material.parameters[Diffuse::Index::albedo] =
      parameter_of(read_color_texture(context, parameters, name, Color(0.25f, 0.12f, 0.06f)));
  parameters.ignore_all();
  return surface;
}

}  // namespace pt::pbrt
