// Colour spaces by name.
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

}  // namespace pt::pbrt
