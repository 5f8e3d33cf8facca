#include "common/scene/mitsuba/surfaces.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace pt::mitsuba {
namespace {

void replaced(Context& context, const Object& bsdf, std::string_view by) {
  context.warn_once("bsdf " + bsdf.type(), bsdf.element(),
                    fmt::format("bsdf '{}' is not supported: {}", bsdf.type(), by));
}

void set_albedo(Surface& surface, const ColorTexture& color) {
  surface.material.albedo = color.color;
  surface.textures.albedo = color.texture;
}

Surface diffuse_of(const ColorTexture& reflectance) {
  Surface surface;
  set_albedo(surface, reflectance);
  surface.material.one_sided = true;
  return surface;
}

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

Surface read_diffuse(Context& context, const Object& bsdf) {
  return diffuse_of(read_color_texture(context, bsdf, "reflectance", Color(0.5f)));
}

Surface read_rough_diffuse(Context& context, const Object& bsdf) {
  replaced(context, bsdf, "diffuse with its reflectance is used");
  bsdf.ignore({"alpha", "use_fast_approx"});
  return read_diffuse(context, bsdf);
}

Surface read_plastic(Context& context, const Object& bsdf) {
  replaced(context, bsdf, "diffuse with its diffuse_reflectance is used, without the coating");
  bsdf.ignore({"alpha", "distribution", "int_ior", "ext_ior", "nonlinear", "specular_reflectance",
               "sample_visible"});
  bsdf.child_named("specular_reflectance");
  return diffuse_of(read_color_texture(context, bsdf, "diffuse_reflectance", Color(0.5f)));
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

Surface read_dielectric(Context& context, const Object& bsdf) {
  Surface surface;
  surface.material = make_dielectric(tint_of(context, bsdf), relative_ior(bsdf));
  return surface;
}

Surface read_rough_dielectric(Context& context, const Object& bsdf) {
  replaced(context, bsdf, "smooth dielectric is used");
  bsdf.ignore({"alpha", "alpha_u", "alpha_v", "distribution", "sample_visible"});
  return read_dielectric(context, bsdf);
}

Surface read_thin_dielectric(Context& context, const Object& bsdf) {
  replaced(context, bsdf, "dielectric of index 1 is used: light passes, and nothing is reflected");
  Surface surface;
  surface.material = make_dielectric(tint_of(context, bsdf), 1.0f);
  bsdf.ignore({"int_ior", "ext_ior"});
  return surface;
}

Surface metal_of(Context& context, const Object& bsdf, float fuzz) {
  Surface surface;
  const ColorTexture specular =
      read_color_texture(context, bsdf, "specular_reflectance", Color(1.0f));
  const Color albedo = conductor_reflectance(context, bsdf) * specular.color;
  surface.material = make_metal(albedo, fuzz);
  surface.textures.albedo = specular.texture;
  return surface;
}

Surface read_conductor(Context& context, const Object& bsdf) {
  context.warn_once("bsdf conductor", bsdf.element(),
                    "bsdf 'conductor' is not supported: metal with its reflectance at normal "
                    "incidence is used");
  return metal_of(context, bsdf, 0.0f);
}

Surface read_rough_conductor(Context& context, const Object& bsdf) {
  replaced(context, bsdf,
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
  replaced(context, bsdf,
           "metal (metallic above 0.5), dielectric (spec_trans above 0.5) or diffuse with its "
           "base_color is used");
  Surface surface = diffuse_of(base);
  if (metallic > 0.5f) {
    surface.material = make_metal(base.color, fuzz_of(roughness * roughness));
  } else if (transmission > 0.5f) {
    surface.material = make_dielectric(base.color, eta > 0.0f ? eta : 1.5f);
  }
  return surface;
}

const Object& only_nested(const Object& bsdf) {
  const Object* nested = bsdf.child("bsdf");
  if (!nested) fail(bsdf.element(), fmt::format("bsdf '{}' has no bsdf inside", bsdf.type()));
  return *nested;
}

Surface read_two_sided(Context& context, const Object& bsdf) {
  if (bsdf.children("bsdf").size() > 1) {
    context.warn_once("two sides", bsdf.element(),
                      "a different bsdf on each side is not supported: the first is used on both");
  }
  Surface surface = read_surface(context, only_nested(bsdf));
  surface.material.one_sided = false;
  return surface;
}

Surface read_mask(Context& context, const Object& bsdf) {
  const ColorTexture opacity = read_color_texture(context, bsdf, "opacity", Color(0.5f));
  Surface surface = read_surface(context, only_nested(bsdf));
  if (opacity.texture == no_texture && is_black(opacity.color)) {
    surface.invisible = true;
  } else if (opacity.texture != no_texture || opacity.color != Color(1.0f)) {
    replaced(context, bsdf, "the bsdf inside is used, opaque");
  }
  return surface;
}

/// bumpmap, normalmap, blendbsdf, coating: what is inside, or the first of it.
Surface read_wrapper(Context& context, const Object& bsdf) {
  replaced(context, bsdf, "the (first) bsdf inside is used as it is");
  bsdf.ignore_all();
  return read_surface(context, only_nested(bsdf));
}

Surface read_null(Context&, const Object&) {
  Surface surface = diffuse_of({Color(0.0f)});
  surface.invisible = true;
  return surface;
}

using Reader = Surface (*)(Context&, const Object&);

const std::map<std::string_view, Reader>& readers() {
  static const std::map<std::string_view, Reader> table = {
      {"diffuse", read_diffuse},
      {"lambertian", read_diffuse},
      {"roughdiffuse", read_rough_diffuse},
      {"plastic", read_plastic},
      {"roughplastic", read_plastic},
      {"dielectric", read_dielectric},
      {"roughdielectric", read_rough_dielectric},
      {"thindielectric", read_thin_dielectric},
      {"conductor", read_conductor},
      {"roughconductor", read_rough_conductor},
      {"principled", read_principled},
      {"principledthin", read_principled},
      {"twosided", read_two_sided},
      {"mask", read_mask},
      {"opacity", read_mask},
      {"bumpmap", read_wrapper},
      {"bump", read_wrapper},
      {"normalmap", read_wrapper},
      {"coating", read_wrapper},
      {"roughcoating", read_wrapper},
      {"blendbsdf", read_wrapper},
      {"mixturebsdf", read_wrapper},
      {"null", read_null},
  };
  return table;
}

}  // namespace

Surface read_surface(Context& context, const Object& bsdf) {
  const auto reader = readers().find(bsdf.type());
  if (reader != readers().end()) return reader->second(context, bsdf);
  replaced(context, bsdf, "diffuse grey is used");
  return diffuse_of({Color(0.5f)});
}

}  // namespace pt::mitsuba
