// Shared by the two principled BSDFs (Burley 2012, 'Physically Based Shading at Disney', and 2015,
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
  float flatness;   ///< in [0, 1]: weight of the approximate subsurface scattering
  float sheen, sheen_tint;

  /// f of diffuse, retro-reflection and sheen, with the approximate subsurface scattering of
  /// Hanrahan and Krueger; cos_d is that of the half vector and either direction.
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

  /// Estimated reflectance, for the choice of lobes; 0 only if the base is black.
  PT_HD float albedo() const { return fmaxf(max_abs(color), sheen); }
};

/// The coat of Principled: a second, isotropic lobe with the long tail of GTR1 (Burley 2012,
/// appendix B).
struct Clearcoat {
  float alpha2;  ///< roughness squared

  /// `gloss` in [0, 1]: roughness from 0.1 to 0.001.
  PT_HD static Clearcoat make(float gloss) {
    const float alpha = fused_multiply_add(gloss, 0.001f - 0.1f, 0.1f);
    return {alpha * alpha};
  }

  /// Density of the facets' area by their unit normal.
  PT_HD float distribution(const Vec3& m) const {
    const float sin2 = fused_multiply_add(m.x, m.x, m.y * m.y);
    return (alpha2 - 1.0f) * inverse_pi /
           (logf(alpha2) * fused_multiply_add(alpha2 * m.z, m.z, sin2));
  }

  /// Density distribution(m) m.z.
  PT_HD Vec3 sample(float u0, float u1) const {
    const SinCos phi = sincos_2pi(u0);
    const float sin2 = (exp2f((1.0f - u1) * log2f(alpha2)) - alpha2) / (1.0f - alpha2);
    const float sine = fast_sqrt(fmaxf(0.0f, sin2));
    return {phi.cos * sine, phi.sin * sine, fast_sqrt(fmaxf(0.0f, 1.0f - sin2))};
  }

  /// Smith's G1 of both directions, with the roughness 0.25 whatever the gloss.
  PT_HD static float visible(const Vec3& o, const Vec3& i) {
    const Microfacets facets{0.25f, 0.25f, false};
    return facets.visible_over_cosine(o) * facets.visible_over_cosine(i) * (o.z * i.z);
  }
};

}  // namespace pt
