// Spectra that pbrt knows by name.
#pragma once

#include <optional>
#include <string_view>

#include "common/math/vec.h"

namespace pt::pbrt {

/// "stdillum-D65" and the like, as linear sRGB of luminance 1.
std::optional<Color> named_illuminant(std::string_view name);

/// "metal-Cu-eta", "metal-Cu-k" and the like, as linear sRGB in daylight.
std::optional<Color> named_metal(std::string_view name);

/// "glass-BK7" and the like: the index of refraction at 587.6 nm.
std::optional<float> named_glass(std::string_view name);

}  // namespace pt::pbrt
