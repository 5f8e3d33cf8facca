// Diffuse and plastic.
#include "common/scene/mitsuba/surface_kinds.h"

namespace pt::mitsuba {
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

}  // namespace pt::mitsuba
