// Glass with a rough surface (Walter et al. 2007, 'Microfacet Models for Refraction through Rough
// Surfaces'). Without roughness it is smooth glass whose reflection and transmission have tints of
// their own.
#pragma once

#include "common/material/bsdf.h"
#include "common/material/dielectric.h"
#include "common/material/microfacet.h"

namespace pt {

struct RoughDielectric {
  static constexpr const char* name = "rough dielectric";
  Color reflected;   ///< tint of reflected light, in [0, 1]; white for real glass
  Color passed;      ///< tint of transmitted light, in [0, 1]; white for real glass
  float eta;         ///< index of refraction inside over outside, > 0
  float alpha_x;     ///< roughness along the tangent, >= 0
  float alpha_y;     ///< roughness along the bitangent, >= 0; both 0: smooth
  bool is_beckmann;  ///< distribution of the facets: Beckmann, else GGX

  static constexpr Field<RoughDielectric> fields[] = {
      {"reflected", &RoughDielectric::reflected},
      {"passed", &RoughDielectric::passed},
      {"eta", &RoughDielectric::eta},
      {"alpha_x", &RoughDielectric::alpha_x},
      {"alpha_y", &RoughDielectric::alpha_y},
      {"is_beckmann", &RoughDielectric::is_beckmann}};
  static constexpr std::uint8_t lobes = Lobe::reflection | Lobe::transmission | Lobe::glossy;

  /// Without a change of index light goes straight on, whatever the facets.
  PT_HD bool is_delta() const { return (alpha_x <= 0.0f && alpha_y <= 0.0f) || eta == 1.0f; }

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& u) const {
    if (is_delta()) {
      BsdfSample s = Dielectric{Color(1.0f), eta}.sample(wo, {u.z, u.x, u.y});
      s.weight *= (s.lobe & Lobe::reflection) != 0 ? reflected : passed;
      return s;
    }
    const Microfacets facets = Microfacets::make(alpha_x, alpha_y, is_beckmann);
    const bool entering = wo.z > 0.0f;
    const float side = entering ? 1.0f : -1.0f;
    const float relative_eta = entering ? eta : divide(1.0f, eta);
    const Vec3 o = side * wo;  // as if from above
    const Vec3 m = facets.sample_visible(o, u.x, u.y);
    const float cos_o = fminf(dot(o, m), 1.0f);
    if (!(cos_o > 0.0f)) return {};
    const float fresnel = fresnel_dielectric(cos_o, relative_eta);
    const bool reflects = u.z < fresnel;
    const Vec3 i = reflects ? mirrored_by(o, m, cos_o) : refracted(o, m, cos_o, relative_eta);
    if ((i.z > 0.0f) != reflects || i.z == 0.0f) return {};
    const float g1_i = facets.visible_over_cosine(i) * fabsf(i.z);
    const float dg1_o = facets.distribution(m) * facets.visible_over_cosine(o);
    const float inside_eta2 = eta * eta;
    if (reflects) {
      return {side * i,
              reflected * g1_i,
              0.25f * dg1_o * fresnel,
              Lobe::reflection | Lobe::glossy,
              1.0f,
              entering ? 1.0f : inside_eta2};
    }
    // Radiance inside is eta^2 times that outside (see dielectric.h).
    return {side * i,
            passed * divide(g1_i, relative_eta * relative_eta),
            dg1_o * transmission_jacobian(o, i, m, relative_eta) * (1.0f - fresnel),
            Lobe::transmission | Lobe::glossy,
            relative_eta,
            entering ? inside_eta2 : 1.0f};
  }

  PT_HD BsdfValue evaluate(const Vec3& wo, const Vec3& wi) const {
    if (is_delta() || wo.z * wi.z == 0.0f) return {};
    const Microfacets facets = Microfacets::make(alpha_x, alpha_y, is_beckmann);
    const bool reflects = same_side(wo, wi);
    const float side = wo.z > 0.0f ? 1.0f : -1.0f;
    const float relative_eta = side > 0.0f ? eta : divide(1.0f, eta);
    const Vec3 o = side * wo, i = side * wi;
    Vec3 m = normalize(add_scaled(o, reflects ? 1.0f : relative_eta, i));
    if (m.z < 0.0f) m = -m;
    const float cos_o = dot(o, m), cos_i = dot(i, m);
    // Else one of the directions is behind the facet.
    if (!(cos_o > 0.0f && (cos_i > 0.0f) == reflects)) return {};
    const float fresnel = fresnel_dielectric(fminf(cos_o, 1.0f), relative_eta);
    const float g1_i = facets.visible_over_cosine(i) * fabsf(i.z);
    const float dg1_o = facets.distribution(m) * facets.visible_over_cosine(o);
    if (reflects) {
      const float pdf = 0.25f * dg1_o * fresnel;
      return {reflected * (pdf * g1_i), pdf};
    }
    const float pdf = dg1_o * transmission_jacobian(o, i, m, relative_eta) * (1.0f - fresnel);
    return {passed * divide(pdf * g1_i, relative_eta * relative_eta), pdf};
  }

 private:
  /// The density of directions i over that of visible normals, times dot(o, m) (Walter et al.,
  /// equation 17).
  PT_HD static float transmission_jacobian(const Vec3& o, const Vec3& i, const Vec3& m,
                                           float relative_eta) {
    const float cos_o = dot(o, m), cos_i = dot(i, m);
    const float sum = fused_multiply_add(relative_eta, cos_i, cos_o);
    return divide(relative_eta * relative_eta * fabsf(cos_i) * cos_o, sum * sum);
  }
};

}  // namespace pt
