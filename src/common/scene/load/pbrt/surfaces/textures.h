// Values that may vary over a surface, and the kinds of textures.
#pragma once

#include <functional>
#include <vector>

#include "common/scene/load/pbrt/surfaces/colors.h"

namespace pt::pbrt {

/// color * texture(u, v).
struct ColorTexture {
  Color color = Color(1.0f);
  std::uint32_t texture = no_texture;

  bool is_constant() const { return texture == no_texture; }
};

inline ColorTexture scaled(ColorTexture value, const Color& by) {
  value.color *= by;
  return value;
}
inline ColorTexture scaled(const ColorTexture& value, float by) { return scaled(value, Color(by)); }

/// A texture and the mappings of what it is made of.
struct ReadTexture {
  ColorTexture value;
  std::vector<TextureMapping> mappings;
};

/// The parameter `name`, a colour or a texture by name, or `fallback` where there is none.
ColorTexture read_color_texture(Context& context, const Parameters& parameters,
                                std::string_view name, const Color& fallback,
                                Quantity quantity = Quantity::albedo);

/// The same of a number: all components are equal.
ColorTexture read_number_texture(Context& context, const Parameters& parameters,
                                 std::string_view name, float fallback);

/// A number that we cannot have as a texture: that becomes its factor with a warning.
float read_plain_number(Context& context, const Parameters& parameters, std::string_view name,
                        float fallback);

pt::Parameter parameter_of(const ColorTexture& value);

// The kinds of textures: each reads one.

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

// Textures computed from others, texel by texel.

/// function(values of `parts`) as an image. Parts that are images with the same map of coordinates
/// give it theirs, and their size, so that texels meet texels; others are looked at over the unit
/// square of (u, v), which repeats.
ColorTexture bake(Context& context, const std::vector<ColorTexture>& parts,
                  const std::function<Color(const std::vector<Color>&)>& function);

}  // namespace pt::pbrt
