// Colours of all kinds to linear sRGB, and textures in their place.
#pragma once

#include "common/math/vec.h"
#include "common/scene/load/files/importer.h"
#include "common/scene/load/mitsuba/xml/context.h"

namespace pt::mitsuba {

/// What a colour is for: it decides the white point of spectra and what is out of range. A
/// `number` is read from the first component; of a texture it is the luminance.
enum class Quantity { reflectance, emission, index_of_refraction, plain, number };

/// <rgb>, <srgb>, <spectrum>, <blackbody>, <vector> or <float> as linear sRGB; `stand_in` in place
/// of a file that cannot be read. Reflectances above 1 become 1 and what is below 0 becomes 0, with
/// a warning; an <rgb> below 0 as a reflectance is an Error, as in Mitsuba.
Color read_color(Context& context, const Element& element, Quantity quantity,
                 const Color& stand_in);

/// Whether an object is a spectrum: a <spectrum type="...">, or a <texture> of one of its types, as
/// Mitsuba's own writer has it.
bool is_spectrum(const Object& object);
/// Whether a <texture> is a picture, and what the integers of such a one mean.
bool is_bitmap(const Object& texture);
TextureFormat integers_of_bitmap(const Object& bitmap);
const std::vector<std::string>& spectrum_types();

/// d65, uniform, srgb, rgb, rawconstant, blackbody, regular and irregular; `stand_in` for others,
/// with a warning, and for a file that cannot be read.
Color read_spectrum_object(Context& context, const Object& object, Quantity quantity,
                           const Color& stand_in);

/// The colour within what the quantity may be, as read_color() has it.
Color bounded_color(Context& context, const Element& element, Color color, Quantity quantity);

/// Throws Error where wavelengths do not ascend.
Samples sorted_samples(const Element& element, Samples samples);

/// spectrum_to_rgb(), of which a warning tells.
Color samples_color(Context& context, const Element& element, const Samples& samples,
                    Quantity quantity);

// Colours that may be textures.

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
