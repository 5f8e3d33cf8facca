// Colours that may be textures.
#pragma once

#include "common/scene/load/mitsuba/surfaces/spectra.h"

namespace pt::mitsuba {

/// color * texture(u, v).
struct ColorTexture {
  Color color = Color(1.0f);
  std::uint32_t texture = no_texture;
};

/// A <texture>, or a spectrum in its place; `stand_in` for what is not supported or cannot be read.
ColorTexture read_texture(Context& context, const Object& object, Quantity quantity,
                          const Color& stand_in);

/// The property or nested texture `name` of `owner`, or `fallback` where it has none, and where
/// what it has cannot be read.
ColorTexture read_color_texture(Context& context, const Object& owner, std::string_view name,
                                const Color& fallback, Quantity quantity = Quantity::reflectance);

/// `name`, or "intensity", which all emitters had before Mitsuba 0.4, where only that is given.
std::string_view emission_name(const Object& emitter, std::string_view name);

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
