// The principled BSDF's coat: a second, isotropic lobe with the long tail of GTR1 (Burley 2012,
// appendix B).
#pragma once

#include "common/material/microfacet.h"

namespace pt {

struct Clearcoat {
  float alpha2;  ///< roughness squared

  /// `gloss` in [0, 1]: roughness from 0.1 to 0.001.
  PT_HD static Clearcoat make(float gloss) {
    const float alpha = fused_multiply_add(gloss, 0.001f - 0.1f, 0.1f);
    return {alpha * alpha};
  }

  /// Density of the facets' area by their unit normal.
  PT_HD float distribution(const Vec3& m) const {
    const float sin2 = fused_multiply_add(m.x, m.x, multiply_rounded(m.y, m.y));
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
