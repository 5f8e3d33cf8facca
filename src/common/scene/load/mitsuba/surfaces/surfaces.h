// <bsdf>s to the nearest of our materials.
#pragma once

#include "common/scene/load/mitsuba/surfaces/textures.h"

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

}  // namespace pt::mitsuba
