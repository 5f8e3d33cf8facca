// Colours that may be textures.
#pragma once

#include "common/scene/load/mitsuba/spectra/spectra.h"

namespace pt::mitsuba {

/// color * texture(u, v).
struct ColorTexture {
  Color color = Color(1.0f);
  std::uint32_t texture = no_texture;
};

/// A <texture>, or a spectrum in its place.
ColorTexture read_texture(Context& context, const Object& object, Quantity quantity);

/// The property or nested texture `name` of `owner`, or `fallback` where it has none.
ColorTexture read_color_texture(Context& context, const Object& owner, std::string_view name,
                                const Color& fallback, Quantity quantity = Quantity::reflectance);

/// A number that may be a texture, as a colour of three equal components.
ColorTexture read_number_texture(Context& context, const Object& owner, std::string_view name,
                                 float fallback);

/// A property that we only have as one number: a texture becomes `fallback` with a warning.
float read_plain_number(Context& context, const Object& owner, std::string_view name,
                        float fallback);

/// The same of a colour, with the mean of the components of `fallback`.
Color read_plain_color(Context& context, const Object& owner, std::string_view name,
                       const Color& fallback, Quantity quantity);

}  // namespace pt::mitsuba
