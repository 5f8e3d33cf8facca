// Diffuse surfaces, smooth and rough.
#include "common/scene/load/mitsuba/surfaces/surface_kinds.h"

namespace pt::mitsuba {

Surface diffuse_of(const ColorTexture& reflectance) {
  Surface surface;
  surface.material.parameters[Diffuse::Index::albedo] = {reflectance.color, reflectance.texture};
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
  Parameter& sigma = surface.material.parameters[OrenNayar::Index::sigma];
  sigma = parameter_of(read_number_texture(context, bsdf, "alpha", 0.2f));
  sigma.value *= std::sqrt(0.5f);
  bsdf.ignore({"use_fast_approx"});
  return surface;
}

}  // namespace pt::mitsuba
