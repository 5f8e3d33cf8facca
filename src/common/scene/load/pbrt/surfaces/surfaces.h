// Materials to the nearest of ours.
#pragma once

#include "common/scene/load/pbrt/textures/color_texture.h"

namespace pt::pbrt {

/// What a material becomes.
struct Surface {
  MaterialDescription material;
  bool invisible = false;      ///< light passes as if nothing were there
  bool keeps_opacity = false;  ///< its material's opacity holds where a shape has no 'alpha'
  std::vector<TextureMapping> mappings = {};  ///< of its textures
};

/// An Error about a name that is not defined has `place`. Each replacement is reported once for its
/// kind. Adding a material is adding a line to the table in surfaces.cpp.
Surface read_surface(Context& context, const MaterialReference& reference, const Place& place);

}  // namespace pt::pbrt
