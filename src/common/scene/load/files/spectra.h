// Spectra to linear sRGB.
#pragma once

#include <utility>
#include <vector>

#include "common/math/vec.h"

namespace pt {

/// wavelength (nm, ascending) -> value
using Samples = std::vector<std::pair<double, double>>;

/// Emission is taken as it is; all else is seen under D65, so that 1 everywhere is white.
enum class Illuminant { equal_energy, d65 };

/// Linear sRGB of a sampled spectrum, with the CIE 1931 observer, as Mitsuba's RGB variants have
/// it.
Color spectrum_to_rgb(const Samples& samples, Illuminant illuminant);

/// Planck's law between two wavelengths in nm, W / (m^2 sr nm), as linear sRGB.
Color blackbody_to_rgb(double kelvin, double from_nm = 0.0, double to_nm = 1e9);

}  // namespace pt
