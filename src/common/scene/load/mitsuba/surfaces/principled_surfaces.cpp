// principled and principledthin.
#include <fmt/format.h>

#include <cmath>

#include "common/scene/load/mitsuba/surfaces/surface_kinds.h"

namespace pt::mitsuba {
namespace {

/// Reads numbers, which may be textures, into the parameters that follow.
struct NumberReader {
  Context& context;
  const Object& bsdf;

  void operator()(Parameter& to, std::string_view name, float fallback = 0.0f) const {
    to = parameter_of(read_number_texture(context, bsdf, name, fallback));
  }
};

/// `eta`, or that of `specular`: 0.08 times it is the reflectance at normal incidence.
float read_eta(Context& context, const Object& bsdf) {
  float specular = read_plain_number(context, bsdf, "specular", 0.5f);
  if (!(specular < 12.5f)) {
    context.warn_once("specular", bsdf.element(),
                      fmt::format("bsdf '{}': specular {} is 12.5 or more, which no index of "
                                  "refraction has: 0.5 is used",
                                  bsdf.type(), specular));
    specular = 0.5f;
  }
  const float by_specular = 2.0f / (1.0f - std::sqrt(0.08f * specular)) - 1.0f;
  const float eta = read_plain_number(context, bsdf, "eta", by_specular);
  if (!(eta > 0.0f) || !std::isfinite(eta)) {
    fail(bsdf.element(), fmt::format("bsdf '{}': index of refraction {}; expected a number above 0",
                                     bsdf.type(), eta));
  }
  return eta;
}

void ignore_sampling_rates(const Object& bsdf) {
  bsdf.ignore({"main_specular_sampling_rate", "clearcoat_sampling_rate",
               "diffuse_reflectance_sampling_rate", "specular_reflectance_sampling_rate",
               "specular_transmittance_sampling_rate", "diffuse_transmittance_sampling_rate"});
}

bool is_zero(const Parameter& p) { return p.texture == no_texture && is_black(p.value); }

}  // namespace

Surface read_principled(Context& context, const Object& bsdf) {
  const NumberReader read{context, bsdf};
  Surface surface;
  surface.material = describe_all<Principled>(0);
  using Index = Principled::Index;
  Parameter* p = surface.material.parameters;
  p[Index::eta].value = Color(read_eta(context, bsdf));
  p[Index::base_color] = parameter_of(read_color_texture(context, bsdf, "base_color", Color(0.5f)));
  read(p[Index::roughness], "roughness", 0.5f);
  read(p[Index::metallic], "metallic"), read(p[Index::spec_trans], "spec_trans");
  read(p[Index::anisotropic], "anisotropic"), read(p[Index::spec_tint], "spec_tint");
  read(p[Index::sheen], "sheen"), read(p[Index::sheen_tint], "sheen_tint");
  read(p[Index::flatness], "flatness");
  read(p[Index::clearcoat], "clearcoat"), read(p[Index::clearcoat_gloss], "clearcoat_gloss");
  ignore_sampling_rates(bsdf);
  const bool opaque = is_zero(p[Index::spec_trans]);
  surface.material.one_sided = opaque;
  // As Mitsuba: light that passes must be bent.
  if (!opaque && p[Index::eta].value.x == 1.0f) p[Index::eta].value = Color(1.001f);
  return surface;
}

Surface read_principled_thin(Context& context, const Object& bsdf) {
  const NumberReader read{context, bsdf};
  Surface surface;
  surface.material = describe_all<PrincipledThin>(0);
  using Index = PrincipledThin::Index;
  Parameter* p = surface.material.parameters;
  p[Index::base_color] = parameter_of(read_color_texture(context, bsdf, "base_color", Color(0.5f)));
  read(p[Index::roughness], "roughness", 0.5f);
  read(p[Index::spec_trans], "spec_trans"), read(p[Index::eta], "eta", 1.5f);
  read(p[Index::anisotropic], "anisotropic"), read(p[Index::spec_tint], "spec_tint");
  read(p[Index::sheen], "sheen"), read(p[Index::sheen_tint], "sheen_tint");
  read(p[Index::flatness], "flatness"), read(p[Index::diff_trans], "diff_trans");
  ignore_sampling_rates(bsdf);
  return surface;
}

}  // namespace pt::mitsuba
