// What an emissive surface emits: a record of its own, which a material refers to.
#pragma once

#include "common/math/vec.h"
#include "common/texture/texture.h"

namespace pt {

/// 32 bytes: two loads.
struct alignas(16) Emission {
  Color radiance = Color(0.0f);        ///< W / (m^2 sr), on the side to which the normal points
  std::uint32_t texture = no_texture;  ///< multiplies it
  float texture_mean = 1.0f;           ///< the texture's mean luminance, for light selection
};

}  // namespace pt
