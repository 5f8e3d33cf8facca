// Colours of all kinds to linear sRGB.
#pragma once

#include "common/scene/load/pbrt/colors/context.h"

namespace pt::pbrt {

/// What a colour is for: pbrt's SpectrumType.
enum class Quantity { albedo, unbounded, illuminant };

/// rgb, spectrum, blackbody or float. An illuminant that is not rgb has luminance 1, whatever its
/// magnitude: pbrt divides each light by that of its spectrum (that of an rgb is of the colour
/// space's white), and its film multiplies by nothing, so that an rgb of 1 is a radiance of 1.
/// An albedo above 1 becomes 1 with a warning; negative numbers are an Error.
Color read_color(Context& context, const Parameter& parameter, Quantity quantity);

/// The same of the parameter `name`, or `fallback` where there is none.
Color read_color(Context& context, const Parameters& parameters, std::string_view name,
                 const Color& fallback, Quantity quantity);

/// An index of refraction that is one number: a float, or a glass by name; of another spectrum the
/// mean.
float read_index(Context& context, const Parameters& parameters, std::string_view name,
                 float fallback);

}  // namespace pt::pbrt
