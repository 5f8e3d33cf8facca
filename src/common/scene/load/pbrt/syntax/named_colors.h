// Colour spaces and spectra that pbrt knows by name.
#pragma once

#include <optional>
#include <string_view>

#include "common/math/vec.h"

namespace pt::pbrt {

enum class ColorSpace { srgb, dci_p3, rec2020, aces };

inline constexpr const char* color_space_names = "srgb, dci-p3, rec2020 or aces2065-1";

/// None for a name that pbrt does not know.
std::optional<ColorSpace> color_space_named(std::string_view name);

/// Linear sRGB to CIE XYZ, white with Y = 1.
glm::dmat3 xyz_from_srgb();

/// Linear colour of the space as linear sRGB; components outside of its gamut become 0.
Color to_srgb(const Color& color, ColorSpace space);

/// CIE xyY with Y = 1 as linear sRGB, likewise.
Color srgb_of_chromaticity(double x, double y);

// Spectra that pbrt knows by name.

/// "stdillum-D65" and the like, as linear sRGB of luminance 1.
std::optional<Color> named_illuminant(std::string_view name);

/// "metal-Cu-eta", "metal-Cu-k" and the like, as linear sRGB in daylight.
std::optional<Color> named_metal(std::string_view name);

/// "glass-BK7" and the like: the index of refraction at 587.6 nm.
std::optional<float> named_glass(std::string_view name);

}  // namespace pt::pbrt
