// The standard observer and daylight, tabulated.
#pragma once

#include <array>

#include "common/math/vec.h"

namespace pt::mitsuba {

inline constexpr int cie_rows = 95;
inline constexpr double cie_first_nm = 360, cie_last_nm = 830, cie_step_nm = 5;

/// The colour matching functions of the CIE 1931 2-degree observer (CIE 018:2019) and the relative
/// power of the CIE standard illuminant D65 (ISO/CIE 11664-2), 100 at 560 nm.
struct CieRow {
  glm::dvec3 xyz;
  double d65;
};

extern const std::array<CieRow, cie_rows> cie_table;

}  // namespace pt::mitsuba
