// Metals by their complex index of refraction: a mirror, or microfacets of it (Walter et al. 2007,
// 'Microfacet Models for Refraction through Rough Surfaces').
#pragma once

#include "common/material/bsdf.h"
#include "common/material/fresnel.h"
#include "common/material/microfacet.h"

namespace pt {

struct Conductor {
  static constexpr const char* name = "conductor";
  /// Indices of the material's parameters.
  struct Index {
    enum : int {
      tint,         ///< in [0, 1]; 1 for real metals
      eta,          ///< real part of the relative index of refraction, per channel
      k,            ///< imaginary part, the absorption
      alpha_x,      ///< roughness along the tangent, >= 0
      alpha_y,      ///< roughness along the bitangent, >= 0
      is_beckmann,  ///< 0: GGX, else Beckmann
      count
    };
  };
  static constexpr int parameter_count = Index::count;
  static constexpr std::uint8_t lobes = Lobe::reflection | Lobe::glossy;

  Color tint;              ///< multiplies what is reflected; white for real metals
  Color eta, k;            ///< complex index of refraction over that of what is outside
  float alpha_x, alpha_y;  ///< roughness along the tangent and the bitangent; both 0: a mirror
  bool is_beckmann;        ///< the facets' distribution, else GGX

  template <class Parameters>
  PT_HD static Conductor make(const Parameters& p) {
    return {p.color(Index::tint),     p.color(Index::eta),
            p.color(Index::k),        p.scalar(Index::alpha_x),
            p.scalar(Index::alpha_y), p.scalar(Index::is_beckmann) != 0.0f};
  }

  template <class Parameter>
  static bool uses_tangent(const Parameter* p) {
    const auto& x = p[Index::alpha_x];
    const auto& y = p[Index::alpha_y];
    return x.value != y.value || x.texture != y.texture;
  }

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
    const Vec3 m = normalize(wo + wi);  // on whose side does not matter to the facets
    const float density = pdf(facets, wo, m);
    const float shown = facets.visible_over_cosine(wi) * fabsf(wi.z);
    return {reflectance(fminf(dot(wo, m), 1.0f)) * (density * shown), density};
  }

  /// Of a facet in diffuse light.
  PT_HD Color average_reflectance() const { return tint * average_fresnel_conductor(eta, k); }

 private:
  PT_HD Color reflectance(float cosine) const { return tint * fresnel_conductor(cosine, eta, k); }

  /// Of directions: that of the visible normals over 4 dot(wo, m).
  PT_HD static float pdf(const Microfacets& facets, const Vec3& wo, const Vec3& m) {
    return multiply_rounded(0.25f * facets.distribution(m), facets.visible_over_cosine(wo));
  }
};

}  // namespace pt
