// Smooth glass: with a volume behind the surface, and a thin pane.
#pragma once

#include "common/material/bsdf.h"
#include "common/material/fresnel.h"

namespace pt {

/// Smooth glass: Fresnel reflection or Snell refraction, chosen at random (pbrt-v4, section 9.5).
struct Dielectric {
  static constexpr const char* name = "dielectric";
  Color tint;  ///< multiplies reflected and transmitted light, in [0, 1]; white for real glass
  float eta;   ///< index of refraction inside over outside, > 0

  static constexpr Field<Dielectric> fields[] = {{"tint", &Dielectric::tint},
                                                 {"eta", &Dielectric::eta}};
  static constexpr std::uint8_t lobes = Lobe::reflection | Lobe::transmission;

  PT_HD bool is_delta() const { return true; }

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& u) const {
    const bool entering = wo.z > 0.0f;
    const float relative_eta = entering ? eta : divide(1.0f, eta);
    const float cos_i = fminf(fabsf(wo.z), 1.0f);
    // Inside of glass radiance is eta^2 times that outside, so a path carries 1 / eta^2 there
    // (pbrt-v4, section 9.5.2). Roulette must not take that for a loss.
    const float inside_eta2 = eta * eta;
    if (u.x < fresnel_dielectric(cos_i, relative_eta)) {
      return {mirrored(wo), tint,
              0.0f,         Lobe::reflection | Lobe::delta,
              1.0f,         entering ? 1.0f : inside_eta2};
    }
    const float inverse_eta = divide(1.0f, relative_eta);
    const float sin2_t = fmaxf(0.0f, (1.0f - cos_i * cos_i) * inverse_eta * inverse_eta);
    const float cos_t = square_root(fmaxf(0.0f, 1.0f - sin2_t));
    return {Vec3(-inverse_eta * wo.x, -inverse_eta * wo.y, entering ? -cos_t : cos_t),
            tint * (inverse_eta * inverse_eta),
            0.0f,
            Lobe::transmission | Lobe::delta,
            relative_eta,
            entering ? inside_eta2 : 1.0f};
  }

  PT_HD BsdfValue evaluate(const Vec3&, const Vec3&) const { return {}; }
};

/// A thin pane of smooth glass, a single surface: light is reflected or leaves undeflected, after
/// any number of internal reflections (pbrt-v4, section 9.5.1).
struct ThinDielectric {
  static constexpr const char* name = "thin dielectric";
  Color reflected;  ///< tint of reflected light, in [0, 1]; white for real glass
  Color passed;     ///< tint of transmitted light, in [0, 1]; white for real glass
  float eta;        ///< index of refraction inside over outside, > 0

  static constexpr Field<ThinDielectric> fields[] = {{"reflected", &ThinDielectric::reflected},
                                                     {"passed", &ThinDielectric::passed},
                                                     {"eta", &ThinDielectric::eta}};
  static constexpr std::uint8_t lobes = Lobe::reflection | Lobe::transmission;

  PT_HD bool is_delta() const { return true; }

  /// R + T R T + T R^3 T + ...
  PT_HD float reflectance(float cosine) const {
    const float once = fresnel_dielectric(fminf(fabsf(cosine), 1.0f), eta);
    return divide(2.0f * once, 1.0f + once);
  }
  PT_HD Color transmittance(float cosine) const {
    return passed * Color(1.0f - reflectance(cosine));
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
