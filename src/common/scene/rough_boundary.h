// How much light a rough boundary of a dielectric lets through.
#pragma once

#include <array>

namespace pt {

struct RoughBoundary {
  /// The part of light from a direction that is refracted and seen beyond the boundary (single
  /// scattering), as a polynomial in the root of its cosine, the constant first: within 0.6 %.
  std::array<float, 7> transmittance;
  /// What it reflects of diffuse light from inside.
  float internal_reflectance;
};

/// As Mitsuba 3's `roughplastic` tabulates it: the internal reflectance is the mean over 64 equal
/// steps of the cosine, which is 1.4 % below the integral.
RoughBoundary measure_rough_boundary(float eta, float alpha, bool is_beckmann);

}  // namespace pt
