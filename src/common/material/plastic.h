// Plastics: a diffuse body under a smooth or rough coat.
#pragma once

#include "common/material/bsdf.h"
#include "common/material/fresnel.h"
#include "common/material/microfacet.h"
#include "common/sampling/warp.h"

namespace pt {

/// The light that leaves the body, and the probability with which samples choose the coat.
struct CoatedBody {
  Color diffuse, specular;
  Color coat;  ///< see Plastic::coat

  PT_HD float eta() const { return coat.x; }

  /// f |cos| of the body. `transmitted`: the coat's transmittance on the way in times that on the
  /// way out, times the cosine over pi.
  PT_HD Color leaving(float transmitted) const {
    const float scale = divide(transmitted, coat.x * coat.x);
    const auto channel = [&](float d) {
      return divide(d * scale, fused_multiply_add(-coat.z, d, 1.0f - coat.y));
    };
    return {channel(diffuse.x), channel(diffuse.y), channel(diffuse.z)};
  }

  /// The probability of sampling the coat, which reflects the part `reflectance`.
  PT_HD float coat_probability(float reflectance) const {
    const float s = reflectance * mean(specular);
    const float sum = fused_multiply_add(1.0f - reflectance, mean(diffuse), s);
    return sum > 0.0f ? divide(s, sum) : 1.0f;
  }
};

/// Smooth plastic: a clear coat over a diffuse body. The body scatters the light that the boundary
/// transmits, and the boundary reflects a part of it back inside, again and again (Mitsuba 3's
/// `plastic`; the sum is that of Saunderson 1942).
struct Plastic {
  static constexpr const char* name = "plastic";
  Color diffuse;   ///< the body's reflectance, in [0, 1]
  Color specular;  ///< multiplies the light that the coat reflects, in [0, 1]
  /// x: index of refraction inside over outside, > 0; y and z: the coat's internal reflectance for
  /// diffuse light. Without Mitsuba's `nonlinear`, y is that reflectance and z is 0: internal
  /// reflections do not colour the light. With it, z is the reflectance and y is 0.
  Color coat;

  static constexpr Field<Plastic> fields[] = {{"diffuse", &Plastic::diffuse},
                                              {"specular", &Plastic::specular},
                                              {"coat", &Plastic::coat, precomputed}};
  static constexpr std::uint8_t lobes = Lobe::reflection | Lobe::diffuse | Lobe::delta;

  PT_HD CoatedBody body() const { return {diffuse, specular, coat}; }

  PT_HD bool is_delta() const { return false; }

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& u) const {
    const float reflected = fresnel_dielectric(fminf(fabsf(wo.z), 1.0f), body().eta());
    const float p = body().coat_probability(reflected);
    if (u.z < p) {
      return {mirrored(wo), specular * divide(reflected, p), 0.0f, Lobe::reflection | Lobe::delta};
    }
    Vec3 wi = sample_cosine_hemisphere(u.x, u.y);
    const float transmitted = (1.0f - reflected) * (1.0f - fresnel_dielectric(wi.z, body().eta()));
    const float pdf = (1.0f - p) * cosine_hemisphere_pdf(wi.z);
    if (wo.z < 0.0f) wi.z = -wi.z;
    return {wi, body().leaving(divide(transmitted, 1.0f - p)), pdf,
            Lobe::reflection | Lobe::diffuse};
  }

  PT_HD BsdfValue evaluate(const Vec3& wo, const Vec3& wi) const {
    if (!same_side(wo, wi)) return {};
    const float reflected = fresnel_dielectric(fminf(fabsf(wo.z), 1.0f), body().eta());
    const float cosine = fminf(fabsf(wi.z), 1.0f);
    const float transmitted =
        (1.0f - reflected) * (1.0f - fresnel_dielectric(cosine, body().eta()));
    const float pdf = cosine_hemisphere_pdf(cosine);
    return {body().leaving(transmitted * pdf), (1.0f - body().coat_probability(reflected)) * pdf};
  }
};

/// Plastic with a rough coat: microfacets that reflect, over a diffuse body (Mitsuba 3's
/// `roughplastic`). The transmittance of the rough boundary is a polynomial, fitted for one
/// roughness (scene/data/plastic_material.h).
struct RoughPlastic {
  static constexpr const char* name = "rough plastic";
  static constexpr int terms = 9;
  Color diffuse;   ///< the body's reflectance, in [0, 1]
  Color specular;  ///< multiplies the light that the coat reflects, in [0, 1]
  float alpha;     ///< roughness of the coat, >= 0
  Color coat;      ///< see Plastic::coat
  Color transmittance_0, transmittance_1, transmittance_2;  ///< the terms of transmittance()
  bool is_beckmann;  ///< distribution of the facets: Beckmann, else GGX

  static constexpr Field<RoughPlastic> fields[] = {
      {"diffuse", &RoughPlastic::diffuse},
      {"specular", &RoughPlastic::specular},
      {"alpha", &RoughPlastic::alpha},
      {"coat", &RoughPlastic::coat, precomputed},
      {"transmittance_0", &RoughPlastic::transmittance_0, precomputed},
      {"transmittance_1", &RoughPlastic::transmittance_1, precomputed},
      {"transmittance_2", &RoughPlastic::transmittance_2, precomputed},
      {"is_beckmann", &RoughPlastic::is_beckmann}};
  static constexpr std::uint8_t lobes = Lobe::reflection | Lobe::diffuse | Lobe::glossy;

  PT_HD CoatedBody body() const { return {diffuse, specular, coat}; }
  PT_HD Microfacets facets() const { return Microfacets::make(alpha, alpha, is_beckmann); }

  PT_HD bool is_delta() const { return false; }

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& u) const {
    Vec3 wi;
    const bool glossy = u.z < body().coat_probability(1.0f - transmittance(wo));
    if (glossy) {
      const Vec3 above(wo.x, wo.y, fabsf(wo.z));
      const Vec3 m = facets().sample_visible(above, u.x, u.y);
      wi = normalize(mirrored_by(above, m, dot(above, m)));
    } else {
      wi = sample_cosine_hemisphere(u.x, u.y);
    }
    if (wo.z < 0.0f) wi.z = -wi.z;
    return sample_of(wi, evaluate(wo, wi), glossy);
  }

  PT_HD BsdfValue evaluate(const Vec3& wo, const Vec3& wi) const {
    if (!same_side(wo, wi)) return {};
    const float transmitted = transmittance(wo);
    const float p = body().coat_probability(1.0f - transmitted);
    const float diffuse_pdf = cosine_hemisphere_pdf(fabsf(wi.z));
    const Vec3 m = normalize(wo + wi);
    const Microfacets rough = facets();
    const float glossy_pdf = 0.25f * rough.distribution(m) * rough.visible_over_cosine(wo);
    const float g1_i = rough.visible_over_cosine(wi) * fabsf(wi.z);
    const float reflected = fresnel_dielectric(fminf(fabsf(dot(wo, m)), 1.0f), body().eta());
    return {add_scaled(body().leaving(transmitted * transmittance(wi) * diffuse_pdf),
                       reflected * g1_i * glossy_pdf, specular),
            fused_multiply_add(p, glossy_pdf, (1.0f - p) * diffuse_pdf)};
  }

 private:
  /// The part of the light along w that the boundary transmits: a polynomial, the constant first.
  PT_HD float transmittance(const Vec3& w) const {
    const float root = fast_sqrt(fminf(fabsf(w.z), 1.0f));
    const float x = fused_multiply_add(2.0f, root, -1.0f);
    const Color &a = transmittance_0, &b = transmittance_1, &c = transmittance_2;
    const float coefficients[terms] = {a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z};
    float sum = coefficients[terms - 1];
    PT_UNROLL(8)
    for (int i = terms - 2; i >= 0; --i) sum = fused_multiply_add(sum, x, coefficients[i]);
    return fminf(fmaxf(sum, 0.0f), 1.0f);
  }
};

}  // namespace pt
