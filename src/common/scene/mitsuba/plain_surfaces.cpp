// Diffuse, plastic, glass and metal.
#include <fmt/format.h>

#include <algorithm>

#include "common/scene/mitsuba/surface_kinds.h"

namespace pt::mitsuba {
namespace {

/// The ball's radius whose median deflection is that of a microfacet lobe. Half of GGX's normals
/// lie within tan(angle) = alpha, which turns the reflected ray by twice the angle; half of the
/// ball's points lie within 0.608 of its radius from the mirror ray.
float fuzz_of(float alpha) { return std::min(1.0f, 2.0f / 0.608f * alpha); }

float alpha_of(Context& context, const Object& bsdf, float fallback) {
  if (bsdf.find("alpha_u") || bsdf.find("alpha_v") || bsdf.child_named("alpha_u") ||
      bsdf.child_named("alpha_v")) {
    context.warn_once("anisotropic", bsdf.element(),
                      "anisotropic roughness is not supported: the mean of alpha_u and alpha_v is "
                      "used");
    return 0.5f * (read_plain_number(context, bsdf, "alpha_u", fallback) +
                   read_plain_number(context, bsdf, "alpha_v", fallback));
  }
  return read_plain_number(context, bsdf, "alpha", fallback);
}

/// The one tint that our glass has.
Color tint_of(Context& context, const Object& bsdf) {
  const Color reflected =
      read_plain_color(context, bsdf, "specular_reflectance", Color(1.0f), Quantity::reflectance);
  const Color passed =
      read_plain_color(context, bsdf, "specular_transmittance", Color(1.0f), Quantity::reflectance);
  if (reflected != passed) {
    context.warn_once("tint", bsdf.element(),
                      "specular_reflectance and specular_transmittance differ: the latter is used "
                      "for both");
  }
  return passed;
}

Surface metal_of(Context& context, const Object& bsdf, float fuzz) {
  Surface surface;
  const ColorTexture specular =
      read_color_texture(context, bsdf, "specular_reflectance", Color(1.0f));
  const Color albedo = conductor_reflectance(context, bsdf) * specular.color;
  surface.material = make_metal(albedo, fuzz);
  surface.material.parameters[0].texture = specular.texture;
  return surface;
}

}  // namespace

Surface diffuse_of(const ColorTexture& reflectance) {
  Surface surface;
  surface.material.parameters[0] = {reflectance.color, reflectance.texture};
  surface.material.one_sided = true;
  return surface;
}

/// 0.x takes either name.
Surface read_diffuse(Context& context, const Object& bsdf) {
  const bool usual = bsdf.find("reflectance") || bsdf.child_named("reflectance");
  const char* name = usual ? "reflectance" : "diffuse_reflectance";
  return diffuse_of(read_color_texture(context, bsdf, name, Color(0.5f)));
}

Surface read_rough_diffuse(Context& context, const Object& bsdf) {
  report_replaced(context, bsdf, "diffuse with its reflectance is used");
  bsdf.ignore({"alpha", "use_fast_approx"});
  return read_diffuse(context, bsdf);
}

Surface read_plastic(Context& context, const Object& bsdf) {
  report_replaced(context, bsdf,
                  "diffuse with its diffuse_reflectance is used, without the coating");
  bsdf.ignore({"alpha", "distribution", "int_ior", "ext_ior", "nonlinear", "specular_reflectance",
               "sample_visible"});
  bsdf.child_named("specular_reflectance");
  return diffuse_of(read_color_texture(context, bsdf, "diffuse_reflectance", Color(0.5f)));
}

Surface read_dielectric(Context& context, const Object& bsdf) {
  Surface surface;
  surface.material = make_dielectric(tint_of(context, bsdf), relative_ior(bsdf));
  return surface;
}

Surface read_rough_dielectric(Context& context, const Object& bsdf) {
  report_replaced(context, bsdf, "smooth dielectric is used");
  bsdf.ignore({"alpha", "alpha_u", "alpha_v", "distribution", "sample_visible"});
  return read_dielectric(context, bsdf);
}

Surface read_thin_dielectric(Context& context, const Object& bsdf) {
  report_replaced(context, bsdf,
                  "dielectric of index 1 is used: light passes, and nothing is reflected");
  Surface surface;
  surface.material = make_dielectric(tint_of(context, bsdf), 1.0f);
  bsdf.ignore({"int_ior", "ext_ior"});
  return surface;
}

Surface read_conductor(Context& context, const Object& bsdf) {
  context.warn_once("bsdf conductor", bsdf.element(),
                    "bsdf 'conductor' is not supported: metal with its reflectance at normal "
                    "incidence is used");
  return metal_of(context, bsdf, 0.0f);
}

Surface read_rough_conductor(Context& context, const Object& bsdf) {
  report_replaced(context, bsdf,
                  "metal with its reflectance at normal incidence and a fuzz of 3.3 alpha is used");
  bsdf.ignore({"distribution", "sample_visible"});
  return metal_of(context, bsdf, fuzz_of(alpha_of(context, bsdf, 0.1f)));
}

Surface read_principled(Context& context, const Object& bsdf) {
  const ColorTexture base = read_color_texture(context, bsdf, "base_color", Color(0.5f));
  const float metallic = read_plain_number(context, bsdf, "metallic", 0.0f);
  const float transmission = read_plain_number(context, bsdf, "spec_trans", 0.0f);
  const float roughness = read_plain_number(context, bsdf, "roughness", 0.5f);
  const float eta = read_plain_number(context, bsdf, "eta", 1.5f);
  bsdf.ignore({"spec_tint", "anisotropic", "sheen", "sheen_tint", "clearcoat", "clearcoat_gloss",
               "specular", "flatness", "diff_trans", "main_specular_sampling_rate",
               "clearcoat_sampling_rate", "diffuse_reflectance_sampling_rate"});
  report_replaced(
      context, bsdf,
      "metal (metallic above 0.5), dielectric (spec_trans above 0.5) or diffuse with its "
      "base_color is used");
  Surface surface = diffuse_of(base);
  if (metallic > 0.5f) {
    surface.material = make_metal(base.color, fuzz_of(roughness * roughness));
    surface.material.parameters[0].texture = base.texture;
  } else if (transmission > 0.5f) {
    surface.material = make_dielectric(base.color, eta > 0.0f ? eta : 1.5f);
    surface.material.parameters[0].texture = base.texture;
  }
  return surface;
}

}  // namespace pt::mitsuba
