// A thin pane of smooth glass, a single surface: light is reflected or leaves undeflected, after
// any number of internal reflections (pbrt-v4, section 9.5.1).
#pragma once

#include "common/material/bsdf.h"
#include "common/material/fresnel.h"

namespace pt {

struct ThinDielectric {
  static constexpr const char* name = "thin dielectric";
  /// Indices of the material's parameters.
  struct Index {
    enum : int {
      reflected,  ///< tint of reflected light, in [0, 1]
      passed,     ///< tint of transmitted light, in [0, 1]
      eta,        ///< relative index of refraction, > 0
      count
    };
  };
  static constexpr int parameter_count = Index::count;
  static constexpr std::uint8_t lobes = Lobe::reflection | Lobe::transmission;

  Color reflected, passed;  ///< tints; white for real glass
  float eta;                ///< index of refraction inside over outside, > 0

  template <class Parameters>
  PT_HD static ThinDielectric make(const Parameters& p) {
    return {p.color(Index::reflected), p.color(Index::passed), p.scalar(Index::eta)};
  }

  PT_HD bool is_delta() const { return true; }

  /// R + T R T + T R^3 T + ...
  PT_HD float reflectance(float cosine) const {
    const float once = fresnel_dielectric(fminf(fabsf(cosine), 1.0f), eta);
    return divide(2.0f * once, 1.0f + once);
  }
  PT_HD Color transmittance(float cosine) const {
    return multiply_rounded(passed, Color(1.0f - reflectance(cosine)));
  }

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& u) const {
    if (u.z < reflectance(wo.z)) {
      return {mirrored(wo), reflected, 0.0f, Lobe::reflection | Lobe::delta};
    }
    return {-wo, passed, 0.0f, Lobe::transmission | Lobe::delta};
  }

  PT_HD BsdfValue evaluate(const Vec3&, const Vec3&) const { return {}; }
};

}  // namespace pt
