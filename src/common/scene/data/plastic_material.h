// Plastics as materials: computes the parameters of the coat, once for each material.
#pragma once

#include <array>

#include "common/scene/data/material_description.h"

namespace pt {

struct PlasticCoat {
  float eta = 1.49f;       ///< index of refraction inside over outside
  bool nonlinear = false;  ///< as in Mitsuba: the body colours each internal reflection
};

MaterialDescription make_plastic(const Color& diffuse, const Color& specular, PlasticCoat coat);

/// `alpha` is the roughness (see Microfacets); a texture of it changes the highlight alone.
MaterialDescription make_rough_plastic(const Color& diffuse, const Color& specular,
                                       PlasticCoat coat, float alpha, bool is_beckmann);

/// Reflectance of a smooth boundary for diffuse light; `eta` as in fresnel_dielectric.
double diffuse_reflectance(double eta);

/// The light that a rough boundary of a dielectric transmits and reflects.
struct RoughBoundary {
  /// The part of the light from a direction that is refracted and leaves the boundary (single
  /// scattering), as a polynomial in 2 sqrt(cosine) - 1, the constant first: within 0.2 %.
  std::array<float, RoughPlastic::terms> transmittance;
  /// Reflectance for diffuse light from inside.
  float internal_reflectance;
};

/// As Mitsuba 3's `roughplastic` tabulates it: the internal reflectance is the mean over 64 equal
/// steps of the cosine, which is 1.4 % below the integral. Takes 0.03 s (Beckmann: 0.2 s), once for
/// each boundary.
RoughBoundary measure_rough_boundary(float eta, float alpha, bool is_beckmann);

}  // namespace pt
