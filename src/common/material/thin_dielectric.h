// A pane of smooth glass: light goes to and fro within it, leaves it undeflected or is reflected,
// and the pane has no inside of its own.
#pragma once

#include "common/material/bsdf.h"
#include "common/material/fresnel.h"

namespace pt {

struct ThinDielectric {
  static constexpr const char* name = "thin dielectric";
  static constexpr int parameter_count = 3;
  static constexpr std::uint8_t lobes = Lobe::reflection | Lobe::transmission;

  Color reflected, passed;  ///< tints; white for real glass
  float eta;                ///< index of refraction inside over outside, > 0

  template <class Parameters>
  PT_HD static ThinDielectric make(const Parameters& p) {
    return {p.color(0), p.color(1), p.scalar(2)};
  }

  PT_HD bool is_delta() const { return true; }

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& u) const {
    const float once = fresnel_dielectric(fminf(fabsf(wo.z), 1.0f), eta);
    // R + T R T + T R^3 T + ...
    const float reflectance = divide(2.0f * once, 1.0f + once);
    if (u.z < reflectance) return {mirrored(wo), reflected, 0.0f, Lobe::reflection | Lobe::delta};
    return {-wo, passed, 0.0f, Lobe::transmission | Lobe::delta};
  }

  PT_HD BsdfValue evaluate(const Vec3&, const Vec3&) const { return {}; }
};

}  // namespace pt
