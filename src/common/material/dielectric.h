// Smooth glass: Fresnel reflection or Snell refraction, chosen at random (pbrt-v4, section 9.5).
#pragma once

#include "common/material/bsdf.h"

namespace pt {

/// Reflectance of unpolarised light at a smooth boundary. `cos_i` in [0, 1] on the incident side,
/// `eta` = transmitted / incident index of refraction.
PT_HD float fresnel_dielectric(float cos_i, float eta) {
  const float sin2_t = (1.0f - cos_i * cos_i) / (eta * eta);
  if (sin2_t >= 1.0f) return 1.0f;
  const float cos_t = sqrtf(1.0f - sin2_t);
  const float parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  const float perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  return 0.5f *
         fused_multiply_add(parallel, parallel, multiply_rounded(perpendicular, perpendicular));
}

struct Dielectric {
  Color tint;  ///< multiplies what passes or is reflected; white for real glass
  float eta;   ///< index of refraction inside over outside, > 0

  PT_HD bool is_delta() const { return true; }

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& n, const Vec4& u) const {
    const float cos_o = dot(wo, n);
    const bool entering = cos_o > 0.0f;
    const Vec3 facing = entering ? n : -n;
    const float relative_eta = entering ? eta : 1.0f / eta;
    const float cos_i = fminf(fabsf(cos_o), 1.0f);
    // Inside of glass radiance is eta^2 times that outside, so a path carries 1 / eta^2 there
    // (pbrt-v4, section 9.5.2). Roulette must not take that for a loss.
    const float inside_eta2 = eta * eta;
    if (u.x < fresnel_dielectric(cos_i, relative_eta)) {
      return {normalize(reflect(wo, facing)), tint, entering ? 1.0f : inside_eta2};
    }
    const float inverse_eta = 1.0f / relative_eta;
    const float sin2_t = fmaxf(0.0f, (1.0f - cos_i * cos_i) * inverse_eta * inverse_eta);
    const float cos_t = sqrtf(fmaxf(0.0f, 1.0f - sin2_t));
    const float across = fused_multiply_add(inverse_eta, cos_i, -cos_t);
    return {normalize(add_scaled(multiply_rounded(Vec3(-inverse_eta), wo), across, facing)),
            tint * (inverse_eta * inverse_eta), entering ? inside_eta2 : 1.0f};
  }

  PT_HD Color evaluate(const Vec3&, const Vec3&, const Vec3&) const { return Color(0.0f); }
  PT_HD float pdf(const Vec3&, const Vec3&, const Vec3&) const { return 0.0f; }
};

}  // namespace pt
