// Diffuse reflection by smooth and by rough surfaces.
#pragma once

#include "common/material/bsdf.h"
#include "common/sampling/warp.h"

namespace pt {

/// Lambertian reflection, on both sides (pbrt-v4, section 9.2).
struct Diffuse {
  static constexpr const char* name = "diffuse";
  Color albedo;  ///< reflectance, in [0, 1]: f = albedo / pi

  static constexpr Field<Diffuse> fields[] = {{"albedo", &Diffuse::albedo}};
  static constexpr std::uint8_t lobes = Lobe::reflection | Lobe::diffuse;

  PT_HD bool is_delta() const { return false; }

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& u) const {
    Vec3 wi = sample_cosine_hemisphere(u.x, u.y);
    const float pdf = cosine_hemisphere_pdf(wi.z);
    if (wo.z < 0.0f) wi.z = -wi.z;
    return {wi, albedo, pdf, Lobe::reflection | Lobe::diffuse};
  }

  PT_HD BsdfValue evaluate(const Vec3& wo, const Vec3& wi) const {
    if (!same_side(wo, wi)) return {};
    const float pdf = cosine_hemisphere_pdf(fabsf(wi.z));
    return {albedo * pdf, pdf};
  }
};

/// Rough diffuse reflection: V-shaped grooves of Lambertian facets whose slopes are normally
/// distributed (Oren and Nayar 1994, 'Generalization of Lambert's Reflectance Model', the
/// qualitative model of section 4.4: without C3 and interreflection).
struct OrenNayar {
  static constexpr const char* name = "oren-nayar";
  Color albedo;  ///< the facets' reflectance, in [0, 1]
  float sigma;   ///< standard deviation of the facets' angle, radians; 0: Lambertian

  static constexpr Field<OrenNayar> fields[] = {{"albedo", &OrenNayar::albedo},
                                                {"sigma", &OrenNayar::sigma}};
  static constexpr std::uint8_t lobes = Lobe::reflection | Lobe::diffuse;

  PT_HD bool is_delta() const { return false; }

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& u) const {
    Vec3 wi = sample_cosine_hemisphere(u.x, u.y);
    const float pdf = cosine_hemisphere_pdf(wi.z);
    if (wo.z < 0.0f) wi.z = -wi.z;
    return {wi, albedo * roughness_factor(wo, wi), pdf, Lobe::reflection | Lobe::diffuse};
  }

  PT_HD BsdfValue evaluate(const Vec3& wo, const Vec3& wi) const {
    if (!same_side(wo, wi)) return {};
    const float pdf = cosine_hemisphere_pdf(fabsf(wi.z));
    return {albedo * (roughness_factor(wo, wi) * pdf), pdf};
  }

 private:
  /// f pi / albedo = A + B max(0, cos(phi_o - phi_i)) sin(alpha) tan(beta); alpha is the larger of
  /// both angles to the normal. At the horizon the albedo is A + B / 2 times that of the facets:
  /// the fit is 1.5 % too large there, which white facets may not be.
  PT_HD float roughness_factor(const Vec3& wo, const Vec3& wi) const {
    const float variance = sigma * sigma;
    const float a = 1.0f - divide(0.5f * variance, variance + 0.33f);
    const float b = divide(0.45f * variance, variance + 0.09f);
    const float both = fused_multiply_add(wo.x, wi.x, wo.y * wi.y);
    const float sine_tangent = divide(fmaxf(both, 0.0f), fmaxf(fabsf(wo.z), fabsf(wi.z)));
    const float most = max_abs(albedo) * fused_multiply_add(0.5f, b, a);
    return divide(fused_multiply_add(b, sine_tangent, a), fmaxf(most, 1.0f));
  }
};

}  // namespace pt
