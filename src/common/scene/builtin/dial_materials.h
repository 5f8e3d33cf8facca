// The materials of the scene `dial`.
#pragma once

#include <cstdint>

#include "common/scene/data/material_description.h"

namespace pt {

/// BSDFs that the dial has.
inline constexpr std::uint32_t dial_kinds = 13;

/// The material of this index of the dial. The first ones are one of each BSDF: ten that reflect
/// about 0.75 of the light, in hues that differ a little, then three kinds of glass, which absorb
/// nothing. The kinds repeat with other roughness, exponent or index, and then with the other
/// distribution of facets where they have two. The first one is diffuse.
MaterialDescription make_dial_material(std::uint32_t index);

}  // namespace pt
