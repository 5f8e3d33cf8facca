// Values that may vary over a surface.
#pragma once

#include "common/scene/load/pbrt/colors/read_color.h"

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

}  // namespace pt::pbrt
