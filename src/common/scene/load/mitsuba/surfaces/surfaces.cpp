#include "common/scene/load/mitsuba/surfaces/surfaces.h"

#include <cmath>
#include <map>
#include <type_traits>

namespace pt::mitsuba {

// Diffuse surfaces, smooth and rough.

Surface diffuse_of(const ColorTexture& reflectance) {
  Surface surface;
  surface.material[&Diffuse::albedo] = {reflectance.color, reflectance.texture};
  surface.material.one_sided = true;
  return surface;
}

/// 0.x takes either name.
Surface read_diffuse(Context& context, const Object& bsdf) {
  const bool usual = bsdf.find("reflectance") || bsdf.child_named("reflectance");
  const char* name = usual ? "reflectance" : "diffuse_reflectance";
  return diffuse_of(read_color_texture(context, bsdf, name, Color(0.5f)));
}

/// Mitsuba 0.x alone has it. There alpha is the root mean square slope, as Beckmann's, of which the
/// angle's deviation is 1 / sqrt(2).
Surface read_rough_diffuse(Context& context, const Object& bsdf) {
  Surface surface = read_diffuse(context, bsdf);
  surface.material.kind = kind_of<OrenNayar>;
  Parameter& sigma = surface.material[&OrenNayar::sigma];
  sigma = parameter_of(read_number_texture(context, bsdf, "alpha", 0.2f));
  sigma.value *= std::sqrt(0.5f);
  bsdf.ignore({"use_fast_approx"});
  return surface;
}

namespace {

// principled and principledthin.

/// Reads the base colour and the numbers: the BSDF's parameters have Mitsuba's names.
template <class Bsdf>
Surface read_parameters(Context& context, const Object& bsdf) {
  Surface surface;
  surface.material = make_material<Bsdf>(0);
  for (int i = 0; i < parameter_count<Bsdf>; ++i) {
    const Field<Bsdf>& field = Bsdf::fields[i];
    Parameter& parameter = surface.material.parameters[i];
    if (field.is_color) {
      parameter = parameter_of(read_color_texture(context, bsdf, field.name, Color(0.5f)));
    } else if (!std::is_same_v<Bsdf, Principled> || !field.is(&Bsdf::eta)) {  // see read_eta
      const float fallback = field.is(&Bsdf::roughness) ? 0.5f : field.is(&Bsdf::eta) ? 1.5f : 0.0f;
      parameter = parameter_of(read_number_texture(context, bsdf, field.name, fallback));
    }
  }
  return surface;
}

/// `eta`, or that of `specular`: 0.08 times it is the reflectance at normal incidence.
float read_eta(Context& context, const Object& bsdf) {
  float specular = read_plain_number(context, bsdf, "specular", 0.5f);
  if (!(specular < 12.5f)) {
    context.warn_once(
        "specular", bsdf.element(),
        "bsdf '{}': specular {} is 12.5 or more, which no index of refraction has: 0.5 is used",
        bsdf.type(), specular);
    specular = 0.5f;
  }
  const float by_specular = 2.0f / (1.0f - std::sqrt(0.08f * specular)) - 1.0f;
  const float eta = read_plain_number(context, bsdf, "eta", by_specular);
  if (!(eta > 0.0f) || !std::isfinite(eta)) {
    fail(bsdf.element(), "bsdf '{}': index of refraction {}; expected a number above 0",
         bsdf.type(), eta);
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
  const float eta = read_eta(context, bsdf);
  Surface surface = read_parameters<Principled>(context, bsdf);
  ignore_sampling_rates(bsdf);
  const bool opaque = is_zero(surface.material[&Principled::spec_trans]);
  surface.material.one_sided = opaque;
  // As Mitsuba: transmitted light must be refracted.
  surface.material[&Principled::eta].value = Color(!opaque && eta == 1.0f ? 1.001f : eta);
  return surface;
}

Surface read_principled_thin(Context& context, const Object& bsdf) {
  Surface surface = read_parameters<PrincipledThin>(context, bsdf);
  ignore_sampling_rates(bsdf);
  return surface;
}

namespace {

using Reader = Surface (*)(Context&, const Object&);

const std::map<std::string_view, Reader>& readers() {
#define PT_MITSUBA_SURFACE(name, read) {name, read},
  static const std::map<std::string_view, Reader> table = {PT_MITSUBA_SURFACES(PT_MITSUBA_SURFACE)};
#undef PT_MITSUBA_SURFACE
  return table;
}

}  // namespace

void report_replaced(Context& context, const Object& bsdf, std::string_view by) {
  context.warn_once("bsdf " + bsdf.type(), bsdf.element(), "bsdf '{}' is not supported: {}",
                    bsdf.type(), by);
}

// Each once, although others may hold it 2^n times.
Surface read_surface(Context& context, const Object& bsdf) {
  if (const auto found = context.surfaces.find(&bsdf); found != context.surfaces.end()) {
    return *found->second;
  }
  const auto reader = readers().find(bsdf.type());
  if (reader == readers().end()) report_replaced(context, bsdf, "diffuse grey is used");
  const Surface surface =
      reader == readers().end() ? diffuse_of({Color(0.5f)}) : reader->second(context, bsdf);
  context.surfaces.emplace(&bsdf, std::make_shared<const Surface>(surface));
  return surface;
}

std::vector<std::string> surface_types() {
  std::vector<std::string> types;
  for (const auto& entry : readers()) types.emplace_back(entry.first);
  return types;
}

}  // namespace pt::mitsuba
