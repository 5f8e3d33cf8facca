// How much light a rough boundary of a dielectric lets through.
#pragma once

#include <array>

#include "common/material/rough_plastic.h"

namespace pt {

struct RoughBoundary {
  /// The part of light from a direction that is refracted and seen beyond the boundary (single
  /// scattering), as a polynomial in 2 sqrt(cosine) - 1, the constant first: within 0.2 %.
  std::array<float, RoughPlastic::terms> transmittance;
  /// What it reflects of diffuse light from inside.
  float internal_reflectance;
};

/// As Mitsuba 3's `roughplastic` tabulates it: the internal reflectance is the mean over 64 equal
/// steps of the cosine, which is 1.4 % below the
/// integral. Takes 0.03 s (Beckmann: 0.2 s), once for each boundary.
RoughBoundary measure_rough_boundary(float eta, float alpha, bool is_beckmann);

}  // namespace pt
