// A rough conductor with the light that its facets send on to each other: single scattering and a
// second lobe that makes up for what is lost (Kulla and Conty 2017, 'Revisiting Physically Based
// Shading at Imageworks'). Reciprocal, unlike a scale of the first lobe (Turquin 2019, 'Practical
// Multiple Scattering Compensation for Microfacet Models'), which would need no second one.
#pragma once

#include "common/material/conductor.h"
#include "common/material/microfacet_loss.h"
#include "common/material/two_lobes.h"

namespace pt {

/// Rough conductors become this by --multiple-scattering.
struct CompensatedConductor {
  static constexpr const char* name = "compensated conductor";
  static constexpr int parameter_count = Conductor::parameter_count;
  static constexpr std::uint8_t lobes = Conductor::lobes | Lobe::diffuse;

  Conductor single;

  template <class Parameters>
  PT_HD static CompensatedConductor make(const Parameters& p) {
    return {Conductor::make(p)};
  }

  template <class Parameter>
  static bool uses_tangent(const Parameter* p) {
    return Conductor::uses_tangent(p);
  }

  PT_HD bool is_delta() const { return single.is_delta(); }

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& u) const {
    if (is_delta()) return single.sample(wo, u);
    const MicrofacetLoss loss = this->loss();
    const bool glossy = u.z >= loss.at(fminf(fabsf(wo.z), 1.0f));
    Vec3 wi;
    if (glossy) {
      const BsdfSample s = single.sample(wo, u);
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

  /// The second lobe is (1 - E(wo)) (1 - E(wi)) / (pi (1 - E_average)) times a colour; it is
  /// sampled by the probability 1 - E(wo).
  PT_HD BsdfValue evaluate(const Vec3& wo, const Vec3& wi) const {
    if (is_delta() || !same_side(wo, wi)) return {};
    const MicrofacetLoss loss = this->loss();
    const float cosine = fminf(fabsf(wi.z), 1.0f);
    const float lost_o = loss.at(fminf(fabsf(wo.z), 1.0f)), lost_i = loss.at(cosine);
    const float back = lost_o * lost_i / loss.average() * cosine_hemisphere_pdf(cosine);
    const BsdfValue first = single.evaluate(wo, wi);
    return {
        add_scaled(first.f, back, color(loss.average())),
        fused_multiply_add(1.0f - lost_o, first.pdf, multiply_rounded(lost_o, loss.pdf(cosine)))};
  }

 private:
  PT_HD MicrofacetLoss loss() const {
    const Microfacets facets = Microfacets::make(single.alpha_x, single.alpha_y);
    return MicrofacetLoss::make(sqrtf(facets.alpha_x * facets.alpha_y), single.is_beckmann);
  }

  /// Of what meets two facets or more: F^2 + F^3 lost + ..., of which 1 - lost leaves at each.
  PT_HD Color color(float lost) const {
    const Color F = glm::min(single.average_reflectance(), Color(1.0f));
    return (1.0f - lost) * F * F / (Color(1.0f) - lost * F);
  }
};

}  // namespace pt
