// Colours of all kinds to linear sRGB.
#pragma once

#include "common/math/vec.h"
#include "common/scene/load/mitsuba/xml/context.h"

namespace pt::mitsuba {

/// What a colour is for: it decides the white point of spectra and what is out of range. A
/// `number` is read from the first component; of a texture it is the luminance.
enum class Quantity { reflectance, emission, index_of_refraction, plain, number };

/// <rgb>, <srgb>, <spectrum>, <blackbody> or <float> as linear sRGB. Reflectances above 1 become 1
/// and indices of refraction below 0 become 0 with a warning; other negative numbers are an Error.
Color read_color(Context& context, const Element& element, Quantity quantity);

/// A <spectrum type="...">: d65 and uniform; others become grey with a warning.
Color read_spectrum_object(Context& context, const Object& object, Quantity quantity);

/// wavelength (nm, ascending) -> value
using Samples = std::vector<std::pair<double, double>>;

/// Linear sRGB of a sampled spectrum, with the CIE 1931 observer, as Mitsuba's RGB variants have
/// it. Emission is taken as it is; all else is seen under D65, so that 1 everywhere is white.
Color spectrum_to_rgb(const Samples& samples, Quantity quantity);

/// Planck's law, W / (m^2 sr nm), as linear sRGB.
Color blackbody_to_rgb(double kelvin);

}  // namespace pt::mitsuba
