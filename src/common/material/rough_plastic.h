// Plastic with a rough coat: microfacets that reflect, over a diffuse body (Mitsuba 3's
// `roughplastic`). What passes the rough boundary is a polynomial, fitted
// for one roughness (scene/data/rough_boundary.h).
#pragma once

#include "common/material/microfacet.h"
#include "common/material/plastic.h"
#include "common/material/two_lobes.h"

namespace pt {

struct RoughPlastic {
  static constexpr const char* name = "rough plastic";
  /// Indices of the material's parameters.
  struct Index {
    enum : int {
      diffuse,          ///< the body's reflectance, in [0, 1]
      specular,         ///< multiplies what the coat reflects, in [0, 1]
      alpha,            ///< roughness of the coat, >= 0
      coat,             ///< see CoatedBody::coat
      transmittance_0,  ///< nine coefficients of transmittance(), the constant first
      transmittance_1,
      transmittance_2,
      is_beckmann,  ///< 0: GGX, else Beckmann
      count
    };
  };
  static constexpr int parameter_count = Index::count;
  static constexpr std::uint8_t lobes = Lobe::reflection | Lobe::diffuse | Lobe::glossy;
  static constexpr int terms = 9;

  CoatedBody body;
  Microfacets facets;
  float coefficients[terms];  ///< of transmittance(), the constant first

  template <class Parameters>
  PT_HD static RoughPlastic make(const Parameters& p) {
    const Color a = p.color(Index::transmittance_0), b = p.color(Index::transmittance_1);
    const Color c = p.color(Index::transmittance_2);
    const float alpha = p.scalar(Index::alpha);
    return {{p.color(Index::diffuse), p.color(Index::specular), p.color(Index::coat)},
            Microfacets::make(alpha, alpha, p.scalar(Index::is_beckmann) != 0.0f),
            {a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z}};
  }

  PT_HD bool is_delta() const { return false; }

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& u) const {
    Vec3 wi;
    const bool glossy = u.z < body.coat_probability(1.0f - transmittance(wo));
    if (glossy) {
      const Vec3 above(wo.x, wo.y, fabsf(wo.z));
      const Vec3 m = facets.sample_visible(above, u.x, u.y);
      wi = normalize(mirrored_by(above, m, dot(above, m)));
    } else {
      wi = sample_cosine_hemisphere(u.x, u.y);
    }
    if (wo.z < 0.0f) wi.z = -wi.z;
    return sample_of(wi, evaluate(wo, wi), glossy);
  }

  PT_HD BsdfValue evaluate(const Vec3& wo, const Vec3& wi) const {
    if (!same_side(wo, wi)) return {};
    const float passed = transmittance(wo);
    const float p = body.coat_probability(1.0f - passed);
    const float diffuse_pdf = cosine_hemisphere_pdf(fabsf(wi.z));
    const Vec3 m = normalize(wo + wi);
    const float glossy_pdf =
        multiply_rounded(0.25f * facets.distribution(m), facets.visible_over_cosine(wo));
    const float seen = facets.visible_over_cosine(wi) * fabsf(wi.z);
    const float reflected = fresnel_dielectric(fminf(fabsf(dot(wo, m)), 1.0f), body.eta());
    return {add_scaled(body.leaving(passed * transmittance(wi) * diffuse_pdf),
                       multiply_rounded(reflected * seen, glossy_pdf), body.specular),
            fused_multiply_add(p, glossy_pdf, multiply_rounded(1.0f - p, diffuse_pdf))};
  }

 private:
  /// The part of the light along w that the boundary does not reflect and that gets through it.
  PT_HD float transmittance(const Vec3& w) const {
    const float root = fast_sqrt(fminf(fabsf(w.z), 1.0f));
    const float x = fused_multiply_add(2.0f, root, -1.0f);
    float sum = coefficients[terms - 1];
    PT_UNROLL(8)
    for (int i = terms - 2; i >= 0; --i) sum = fused_multiply_add(sum, x, coefficients[i]);
    return fminf(fmaxf(sum, 0.0f), 1.0f);
  }
};

}  // namespace pt
