// The kinds of textures: each reads one.
#pragma once

#include "common/scene/load/pbrt/textures/color_texture.h"

namespace pt::pbrt {

/// What a texture is read for.
struct TextureUse {
  bool is_number;                ///< a float texture
  Quantity quantity;             ///< of a spectrum texture
  Color stand_in = Color(0.5f);  ///< of a picture that cannot be read
};

ColorTexture read_image_map(Context& context, const Entity& entity, const TextureUse& use);
ColorTexture read_constant(Context& context, const Entity& entity, const TextureUse& use);
ColorTexture read_scale(Context& context, const Entity& entity, const TextureUse& use);
ColorTexture read_mix(Context& context, const Entity& entity, const TextureUse& use);
ColorTexture read_checkerboard(Context& context, const Entity& entity, const TextureUse& use);

/// A part of a texture, itself a texture or a value.
ColorTexture read_part(Context& context, const Parameters& parameters, std::string_view name,
                       float fallback, const TextureUse& use);

/// How the texture lies on surfaces: uscale and the like into its map, and all into
/// Context::mappings.
void read_mapping(Context& context, const Entity& entity, Texture& texture);

}  // namespace pt::pbrt
