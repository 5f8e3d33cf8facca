// What a surface that shines emits: the light's own record, which a material only names.
#pragma once

#include "common/math/vec.h"
#include "common/texture/texture.h"

namespace pt {

/// 32 bytes: two loads.
struct alignas(16) Emission {
  Color radiance = Color(0.0f);        ///< on the side to which the normal points
  std::uint32_t texture = no_texture;  ///< multiplies it
  float texture_mean = 1.0f;           ///< its luminance, by which lights are chosen
};

}  // namespace pt
