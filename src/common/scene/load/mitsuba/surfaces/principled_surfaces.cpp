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
  const float specular = read_plain_number(context, bsdf, "specular", 0.5f);
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
  surface.material = describe_all<Principled>(0, 0, 0, 0, read_eta(context, bsdf));
  Parameter* p = surface.material.parameters;
  p[0] = parameter_of(read_color_texture(context, bsdf, "base_color", Color(0.5f)));
  read(p[1], "roughness", 0.5f);
  read(p[2], "metallic"), read(p[3], "spec_trans");
  read(p[5], "anisotropic"), read(p[6], "spec_tint");
  read(p[7], "sheen"), read(p[8], "sheen_tint"), read(p[9], "flatness");
  read(p[10], "clearcoat"), read(p[11], "clearcoat_gloss");
  ignore_sampling_rates(bsdf);
  const bool opaque = is_zero(p[3]);
  surface.material.one_sided = opaque;
  // As Mitsuba: light that passes must be bent.
  if (!opaque && p[4].value.x == 1.0f) p[4].value = Color(1.001f);
  return surface;
}

Surface read_principled_thin(Context& context, const Object& bsdf) {
  const NumberReader read{context, bsdf};
  Surface surface;
  surface.material = describe_all<PrincipledThin>(0);
  Parameter* p = surface.material.parameters;
  p[0] = parameter_of(read_color_texture(context, bsdf, "base_color", Color(0.5f)));
  read(p[1], "roughness", 0.5f);
  read(p[2], "spec_trans"), read(p[3], "eta", 1.5f);
  read(p[4], "anisotropic"), read(p[5], "spec_tint");
  read(p[6], "sheen"), read(p[7], "sheen_tint"), read(p[8], "flatness");
  read(p[9], "diff_trans");
  ignore_sampling_rates(bsdf);
  return surface;
}

}  // namespace pt::mitsuba
