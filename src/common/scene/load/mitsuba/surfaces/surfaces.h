// <bsdf>s to the nearest of our materials.
#pragma once

#include "common/scene/load/mitsuba/surfaces/textures.h"
#include "common/scene/load/mitsuba/xml/context.h"

namespace pt::mitsuba {

/// What a bsdf becomes.
struct Surface {
  MaterialDescription material;
  bool invisible = false;  ///< light passes as if nothing were there
};

/// Each replacement is reported once for its kind. Adding a bsdf is adding a line to the table in
/// surfaces.cpp.
Surface read_surface(Context& context, const Object& bsdf);

/// int_ior / ext_ior, numbers or names (bk7, air, ...); `inside` where the file says nothing.
float relative_ior(const Object& bsdf, std::string_view inside = "bk7");

/// ext_eta of conductors in 0.x, likewise; 1 where there is none.
float outside_ior(const Object& bsdf);

/// All types of bsdfs that are read.
std::vector<std::string> surface_types();

// The kinds of bsdfs: each reads one.

/// Reports, once for its type, that a bsdf is replaced `by` something.
void report_replaced(Context& context, const Object& bsdf, std::string_view by);

/// Roughness of microfacets.
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

// Metals by name.

/// The complex index of refraction eta + i k, in linear sRGB as Mitsuba 3 has it.
struct ConductorIndex {
  std::string_view name;
  Color eta, k;
};

/// All that Mitsuba knows, and "none", which reflects everything.
extern const std::vector<ConductorIndex> conductors;

}  // namespace pt::mitsuba
