// What AttributeBegin remembers and AttributeEnd brings back.
#pragma once

#include "common/scene/load/pbrt/description/description.h"

namespace pt::pbrt {

struct GraphicsState {
  Affine to_world;
  bool moves_start = true;  ///< transformations apply at the beginning of the shutter's interval
  bool reverse = false;
  ColorSpace space = ColorSpace::srgb;
  MaterialReference material;
  EntityPointer area_light;
  MediumNames media;
  /// By target; what follows shares them.
  std::map<std::string, std::shared_ptr<const SharedParameters>, std::less<>> attributes;
};

}  // namespace pt::pbrt
