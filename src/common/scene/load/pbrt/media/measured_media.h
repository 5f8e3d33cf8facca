// Coefficients of materials that were measured, by name.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/math/vec.h"

namespace pt::pbrt {

/// In 1 / mm; the scattering is the reduced one, (1 - g) sigma_s.
struct MeasuredMedium {
  Color absorption, scattering;
};

std::optional<MeasuredMedium> measured_medium(std::string_view name);

/// All of them, for messages.
std::string measured_media_names();

}  // namespace pt::pbrt
