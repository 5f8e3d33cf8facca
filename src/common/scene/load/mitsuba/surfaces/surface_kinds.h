// The kinds of bsdfs: each reads one.
#pragma once

#include "common/scene/load/mitsuba/surfaces/surfaces.h"

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

// The types of bsdfs and who reads them.
#define PT_MITSUBA_SURFACES(READER)                \
  READER("diffuse", read_diffuse)                  \
  READER("lambertian", read_diffuse)               \
  READER("roughdiffuse", read_rough_diffuse)       \
  READER("plastic", read_plastic)                  \
  READER("roughplastic", read_rough_plastic)       \
  READER("phong", read_phong)                      \
  READER("ward", read_ward)                        \
  READER("dielectric", read_dielectric)            \
  READER("roughdielectric", read_rough_dielectric) \
  READER("thindielectric", read_thin_dielectric)   \
  READER("conductor", read_conductor)              \
  READER("roughconductor", read_rough_conductor)   \
  READER("principled", read_principled)            \
  READER("principledthin", read_principled_thin)   \
  READER("twosided", read_two_sided)               \
  READER("mask", read_mask)                        \
  READER("opacity", read_mask)                     \
  READER("bumpmap", read_bump_map)                 \
  READER("bump", read_bump_map)                    \
  READER("normalmap", read_normal_map)             \
  READER("coating", read_wrapper)                  \
  READER("roughcoating", read_wrapper)             \
  READER("blendbsdf", read_blend)                  \
  READER("mixturebsdf", read_mixture)              \
  READER("null", read_null)

#define PT_MITSUBA_SURFACE(name, read) Surface read(Context& context, const Object& bsdf);
PT_MITSUBA_SURFACES(PT_MITSUBA_SURFACE)
#undef PT_MITSUBA_SURFACE

}  // namespace pt::mitsuba
