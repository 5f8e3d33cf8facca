// What the two principled BSDFs share (Burley 2012, 'Physically Based Shading at Disney', and 2015,
// 'Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering'), with the choices of
// Mitsuba 3. Cosines here are not negative.
#pragma once

#include "common/material/fresnel.h"
#include "common/material/microfacet.h"

namespace pt {

/// The colour at luminance 1; white for black.
PT_HD Color hue(const Color& c) {
  const float luminance = dot(c, Vec3(0.212671f, 0.715160f, 0.072169f));
  return luminance > 0.0f ? divide(c, luminance) : Color(1.0f);
}

/// (1 - cosine)^5: Schlick's interpolation from the reflectance at normal incidence to 1.
PT_HD float schlick_weight(float cosine) {
  const float m = fminf(fmaxf(1.0f - cosine, 0.0f), 1.0f);
  return m * m * (m * m) * m;
}

/// Schlick's weight at a boundary: below eta 1 the angle is that of the refracted ray.
PT_HD float schlick_weight(float cosine, float eta) {
  if (eta > 1.0f) return schlick_weight(cosine);
  const float sin2 = divide(fused_multiply_add(-cosine, cosine, 1.0f), eta * eta);
  return schlick_weight(square_root(fmaxf(0.0f, 1.0f - sin2)));
}

/// Schlick's reflectance at normal incidence.
PT_HD float normal_reflectance(float eta) {
  const float root = divide(eta - 1.0f, eta + 1.0f);
  return root * root;
}

/// GGX of a roughness between 0 and 1, longer along the tangent where it is anisotropic.
PT_HD Microfacets principled_facets(float roughness, float anisotropic) {
  const float alpha = roughness * roughness;
  const float aspect = square_root(fused_multiply_add(-0.9f, anisotropic, 1.0f));
  return {fmaxf(divide(alpha, aspect), 0.001f), fmaxf(alpha * aspect, 0.001f), false};
}

/// The diffuse base with its sheen: Burley 2012, section 5.3.
struct PrincipledBase {
  Color color;      ///< base colour, in [0, 1]
  float roughness;  ///< in [0, 1]
  float flatness;   ///< in [0, 1]: weight of the fake subsurface scattering
  float sheen, sheen_tint;

  /// f of diffuse, retro-reflection and sheen, with the fake subsurface scattering of Hanrahan
  /// and Krueger; cos_d is that of the half vector and either direction.
  PT_HD Color evaluate(float cos_o, float cos_i, float cos_d) const {
    const float Fo = schlick_weight(cos_o), Fi = schlick_weight(cos_i);
    const float Rr = 2.0f * roughness * cos_d * cos_d;
    const float retro = Rr * fused_multiply_add(Fo * Fi, Rr - 1.0f, Fo + Fi);
    const float diffuse = fused_multiply_add(fused_multiply_add(-0.5f, Fo, 1.0f),
                                             fused_multiply_add(-0.5f, Fi, 1.0f), retro);
    const float Fss = interpolate(1.0f, 0.5f * Rr, Fo) * interpolate(1.0f, 0.5f * Rr, Fi);
    const float subsurface =
        1.25f * fused_multiply_add(Fss, divide(1.0f, cos_o + cos_i) - 0.5f, 0.5f);
    const Color fuzz = interpolate(Color(1.0f), hue(color), sheen_tint);
    return add_scaled(fuzz * (sheen * schlick_weight(cos_d)),
                      inverse_pi * interpolate(diffuse, subsurface, flatness), color);
  }

  /// Estimated reflectance, for the choice of lobes; 0 only where it reflects nothing.
  PT_HD float albedo() const { return fmaxf(max_abs(color), sheen); }
};

}  // namespace pt
