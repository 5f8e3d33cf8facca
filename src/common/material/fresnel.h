// Fresnel equations for unpolarised light at smooth dielectrics and conductors (pbrt-v4,
// sections 9.3.5 and 9.3.6).
#pragma once

#include "common/math/vec.h"

namespace pt {

/// Reflectance of unpolarised light at a smooth boundary. `cos_i` in [0, 1] on the incident side,
/// `eta` = transmitted / incident index of refraction.
PT_HD float fresnel_dielectric(float cos_i, float eta) {
  const float sin2_t = divide(1.0f - cos_i * cos_i, eta * eta);
  if (sin2_t >= 1.0f) return 1.0f;
  const float cos_t = square_root(1.0f - sin2_t);
  const float parallel = divide(eta * cos_i - cos_t, eta * cos_i + cos_t);
  const float perpendicular = divide(cos_i - eta * cos_t, cos_i + eta * cos_t);
  return 0.5f * fused_multiply_add(parallel, parallel, perpendicular * perpendicular);
}

/// The same for a boundary with the complex relative index eta + i k; eta and k are not negative
/// and not both 0 (Born and Wolf, 'Principles of Optics', section 14.2, without complex numbers).
PT_HD float fresnel_conductor(float cos_i, float eta, float k) {
  const float cos2 = cos_i * cos_i;
  const float sin2 = fmaxf(0.0f, 1.0f - cos2);
  // (a + i b)^2 = (eta + i k)^2 - sin^2; `norm` is a^2 + b^2.
  const float real = difference_of_products(eta, eta, k, k) - sin2;
  const float imaginary = 2.0f * eta * k;
  const float norm = square_root(fused_multiply_add(real, real, imaginary * imaginary));
  const float a = square_root(fmaxf(0.0f, 0.5f * (norm + real)));
  const float mixed = 2.0f * a * cos_i;
  const float perpendicular = divide(norm + cos2 - mixed, norm + cos2 + mixed);
  const float both = fused_multiply_add(cos2, norm, sin2 * sin2);
  const float skew = mixed * sin2;
  const float ratio = divide(both - skew, fmaxf(both + skew, 1e-30f));
  return 0.5f * fused_multiply_add(perpendicular, ratio, perpendicular);
}

PT_HD Color fresnel_conductor(float cos_i, const Color& eta, const Color& k) {
  return {fresnel_conductor(cos_i, eta.x, k.x), fresnel_conductor(cos_i, eta.y, k.y),
          fresnel_conductor(cos_i, eta.z, k.z)};
}

/// Its mean over the directions of diffuse light, the integral of 2 cos F d cos: Gauss's two points
/// for the weight cos. Within 0.008 for metals.
PT_HD Color average_fresnel_conductor(const Color& eta, const Color& k) {
  return add_scaled(0.6360828f * fresnel_conductor(0.8449490f, eta, k), 0.3639172f,
                    fresnel_conductor(0.3550510f, eta, k));
}

}  // namespace pt
