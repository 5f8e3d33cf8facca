// Glass: solid, rough and thin.
#include "common/scene/load/mitsuba/surfaces/surface_kinds.h"

namespace pt::mitsuba {
namespace {

ColorTexture tint(Context& context, const Object& bsdf, std::string_view name) {
  return read_color_texture(context, bsdf, name, Color(1.0f));
}

bool is_plain(const ColorTexture& a, const ColorTexture& b) {
  return a.texture == no_texture && b.texture == no_texture && a.color == b.color;
}

}  // namespace

Parameter parameter_of(const ColorTexture& value) { return {value.color, value.texture}; }

/// Smooth glass of one tint, which most is, has a BSDF of its own.
Surface read_dielectric(Context& context, const Object& bsdf) {
  const ColorTexture reflected = tint(context, bsdf, "specular_reflectance");
  const ColorTexture passed = tint(context, bsdf, "specular_transmittance");
  const float eta = relative_ior(bsdf);
  Surface surface;
  if (is_plain(reflected, passed)) {
    surface.material = make_dielectric(passed.color, eta);
  } else {
    surface.material = describe_all<RoughDielectric>(0, 0, eta, 0, 0, 0);
    surface.material.parameters[RoughDielectric::Index::reflected] = parameter_of(reflected);
    surface.material.parameters[RoughDielectric::Index::passed] = parameter_of(passed);
  }
  return surface;
}

Surface read_rough_dielectric(Context& context, const Object& bsdf) {
  const Roughness roughness = read_roughness(context, bsdf);
  Surface surface;
  surface.material = describe_all<RoughDielectric>(0, 0, relative_ior(bsdf));
  using Index = RoughDielectric::Index;
  Parameter* parameters = surface.material.parameters;
  parameters[Index::reflected] = parameter_of(tint(context, bsdf, "specular_reflectance"));
  parameters[Index::passed] = parameter_of(tint(context, bsdf, "specular_transmittance"));
  roughness.store(parameters + Index::alpha_x);
  return surface;
}

Surface read_thin_dielectric(Context& context, const Object& bsdf) {
  Surface surface;
  surface.material = describe_all<ThinDielectric>(0, 0, relative_ior(bsdf));
  using Index = ThinDielectric::Index;
  surface.material.parameters[Index::reflected] =
      parameter_of(tint(context, bsdf, "specular_reflectance"));
  surface.material.parameters[Index::passed] =
      parameter_of(tint(context, bsdf, "specular_transmittance"));
  return surface;
}

}  // namespace pt::mitsuba
