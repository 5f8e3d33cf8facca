// The kinds of bsdfs: each reads one.
#pragma once

#include "common/scene/mitsuba/surfaces.h"

namespace pt::mitsuba {

/// Reports, once for its type, that a bsdf is replaced `by` something.
void report_replaced(Context& context, const Object& bsdf, std::string_view by);

Parameter parameter_of(const ColorTexture& value);

/// Of microfacets.
struct Roughness {
  ColorTexture alpha_u, alpha_v;
  bool is_beckmann;

  /// As the three parameters that end those of Conductor and RoughDielectric.
  void store(Parameter* parameters) const;
};
Roughness read_roughness(Context& context, const Object& bsdf);

/// Diffuse on the side of the normal only.
Surface diffuse_of(const ColorTexture& reflectance);

Surface read_diffuse(Context& context, const Object& bsdf);
Surface read_rough_diffuse(Context& context, const Object& bsdf);
Surface read_plastic(Context& context, const Object& bsdf);
Surface read_rough_plastic(Context& context, const Object& bsdf);
Surface read_phong(Context& context, const Object& bsdf);
Surface read_ward(Context& context, const Object& bsdf);
Surface read_dielectric(Context& context, const Object& bsdf);
Surface read_rough_dielectric(Context& context, const Object& bsdf);
Surface read_thin_dielectric(Context& context, const Object& bsdf);
Surface read_conductor(Context& context, const Object& bsdf);
Surface read_rough_conductor(Context& context, const Object& bsdf);
Surface read_principled(Context& context, const Object& bsdf);
Surface read_principled_thin(Context& context, const Object& bsdf);
Surface read_two_sided(Context& context, const Object& bsdf);
Surface read_mask(Context& context, const Object& bsdf);
Surface read_normal_map(Context& context, const Object& bsdf);
Surface read_bump_map(Context& context, const Object& bsdf);
Surface read_blend(Context& context, const Object& bsdf);
Surface read_mixture(Context& context, const Object& bsdf);
Surface read_wrapper(Context& context, const Object& bsdf);
Surface read_null(Context& context, const Object& bsdf);

}  // namespace pt::mitsuba
