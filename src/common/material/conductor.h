// Metals by their complex index of refraction.
#pragma once

#include "common/material/bsdf.h"
#include "common/material/fresnel.h"
#include "common/material/microfacet.h"
#include "common/material/microfacet_loss.h"
#include "common/sampling/warp.h"

namespace pt {

/// A mirror, or single scattering by microfacets of it (Walter et al. 2007, 'Microfacet Models for
/// Refraction through Rough Surfaces').
struct Conductor {
  static constexpr const char* name = "conductor";
  Color tint;        ///< multiplies reflected light, in [0, 1]; white for real metals
  Color eta;         ///< real part of the index of refraction over that outside, per channel
  Color k;           ///< its imaginary part, the absorption
  float alpha_x;     ///< roughness along the tangent, >= 0
  float alpha_y;     ///< roughness along the bitangent, >= 0; both 0: a mirror
  bool is_beckmann;  ///< distribution of the facets: Beckmann, else GGX

  static constexpr Field<Conductor> fields[] = {{"tint", &Conductor::tint},
                                                {"eta", &Conductor::eta},
                                                {"k", &Conductor::k},
                                                {"alpha_x", &Conductor::alpha_x},
                                                {"alpha_y", &Conductor::alpha_y},
                                                {"is_beckmann", &Conductor::is_beckmann}};
  static constexpr std::uint8_t lobes = Lobe::reflection | Lobe::glossy;

  PT_HD bool is_delta() const { return alpha_x <= 0.0f && alpha_y <= 0.0f; }

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& u) const {
    const float side = copysignf(1.0f, wo.z);
    if (is_delta()) {
      return {mirrored(wo), reflectance(fminf(fabsf(wo.z), 1.0f)), 0.0f,
              Lobe::reflection | Lobe::delta};
    }
    const Microfacets facets = Microfacets::make(alpha_x, alpha_y, is_beckmann);
    const Vec3 o = side * wo;
    const Vec3 m = facets.sample_visible(o, u.x, u.y);
    const float cosine = fminf(dot(o, m), 1.0f);
    const Vec3 i = mirrored_by(o, m, cosine);
    if (!(i.z > 0.0f && cosine > 0.0f)) return {};
    return {side * i, reflectance(cosine) * (facets.visible_over_cosine(i) * i.z),
            pdf(facets, o, m), Lobe::reflection | Lobe::glossy};
  }

  PT_HD BsdfValue evaluate(const Vec3& wo, const Vec3& wi) const {
    if (is_delta() || !same_side(wo, wi)) return {};
    const Microfacets facets = Microfacets::make(alpha_x, alpha_y, is_beckmann);
    const Vec3 m = normalize(wo + wi);  // the facets are the same for m and -m
    const float density = pdf(facets, wo, m);
    const float g1_i = facets.visible_over_cosine(wi) * fabsf(wi.z);
    return {reflectance(fminf(dot(wo, m), 1.0f)) * (density * g1_i), density};
  }

  /// The reflectance of a facet in diffuse light.
  PT_HD Color average_reflectance() const { return tint * average_fresnel_conductor(eta, k); }

 private:
  PT_HD Color reflectance(float cosine) const { return tint * fresnel_conductor(cosine, eta, k); }

  /// Density of directions: that of the visible normals over 4 dot(wo, m).
  PT_HD static float pdf(const Microfacets& facets, const Vec3& wo, const Vec3& m) {
    return 0.25f * facets.distribution(m) * facets.visible_over_cosine(wo);
  }
};

/// A rough conductor with the light that its facets reflect onto each other: single scattering and
/// a second lobe that restores the lost energy (Kulla and Conty 2017, 'Revisiting Physically Based
/// Shading at Imageworks'). Reciprocal, unlike a scale of the first lobe (Turquin 2019, 'Practical
/// Multiple Scattering Compensation for Microfacet Models'), which would need no second one.
/// --multiple-scattering turns rough conductors into this.
struct CompensatedConductor : Conductor {
  static constexpr const char* name = "compensated conductor";
  static constexpr std::uint8_t lobes = Conductor::lobes | Lobe::diffuse;

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& u) const {
    if (is_delta()) return Conductor::sample(wo, u);
    const MicrofacetLoss loss = this->loss();
    const bool glossy = u.z >= loss.at(fminf(fabsf(wo.z), 1.0f));
    Vec3 wi;
    if (glossy) {
      const BsdfSample s = Conductor::sample(wo, u);
      if (!(s.pdf > 0.0f)) return {};
      wi = s.wi;
    } else {
      const float cosine = loss.sample_cosine(u.x);
      const float sine = sqrtf(fmaxf(0.0f, fused_multiply_add(-cosine, cosine, 1.0f)));
      const SinCos phi = sincos_2pi(u.y);
      wi = {sine * phi.cos, sine * phi.sin, copysignf(cosine, wo.z)};
    }
    return sample_of(wi, evaluate(wo, wi), glossy);
  }

  /// The second lobe is (1 - E(wo)) (1 - E(wi)) / (pi (1 - E_average)) times a colour; its
  /// probability is 1 - E(wo).
  PT_HD BsdfValue evaluate(const Vec3& wo, const Vec3& wi) const {
    if (is_delta() || !same_side(wo, wi)) return {};
    const MicrofacetLoss loss = this->loss();
    const float cosine = fminf(fabsf(wi.z), 1.0f);
    const float lost_o = loss.at(fminf(fabsf(wo.z), 1.0f)), lost_i = loss.at(cosine);
    const float back = lost_o * lost_i / loss.average() * cosine_hemisphere_pdf(cosine);
    const BsdfValue first = Conductor::evaluate(wo, wi);
    return {add_scaled(first.f, back, color(loss.average())),
            fused_multiply_add(1.0f - lost_o, first.pdf, lost_o * loss.pdf(cosine))};
  }

 private:
  PT_HD MicrofacetLoss loss() const {
    const Microfacets facets = Microfacets::make(alpha_x, alpha_y);
    return MicrofacetLoss::make(sqrtf(facets.alpha_x * facets.alpha_y), is_beckmann);
  }

  /// The colour of light after two facets or more: F^2 + F^3 lost + ..., where the part 1 - lost
  /// leaves the surface at each.
  PT_HD Color color(float lost) const {
    const Color F = glm::min(average_reflectance(), Color(1.0f));
    return (1.0f - lost) * F * F / (Color(1.0f) - lost * F);
  }
};

}  // namespace pt
