// The principled BSDF of a thin sheet, a single surface, with the parameters and lobes of Mitsuba
// 3's `principledthin` (Burley 2015, see principled_lobes.h): the same on both sides; transmitted
// light is blurred by the roughness but not refracted.
#pragma once

#include "common/material/bsdf.h"
#include "common/material/principled_lobes.h"

namespace pt {

struct PrincipledThin {
  static constexpr const char* name = "thin principled";
  Color base_color;   ///< in [0, 1]
  float roughness;    ///< in [0, 1]; alpha = roughness^2
  float spec_trans;   ///< in [0, 1]: opaque to clear
  float eta;          ///< index of refraction of the sheet over that outside, > 0
  float anisotropic;  ///< in [0, 1]: facets stretched along the tangent
  float spec_tint;    ///< in [0, 1]: white to coloured highlights
  float sheen;        ///< >= 0: scale of the grazing lobe of cloth
  float sheen_tint;   ///< in [0, 1]: white to coloured
  float flatness;     ///< in [0, 1]: diffuse to approximate subsurface scattering
  float diff_trans;   ///< in [0, 2]: 1 is half reflected, half transmitted

  static constexpr Field<PrincipledThin> fields[] = {{"base_color", &PrincipledThin::base_color},
                                                     {"roughness", &PrincipledThin::roughness},
                                                     {"spec_trans", &PrincipledThin::spec_trans},
                                                     {"eta", &PrincipledThin::eta},
                                                     {"anisotropic", &PrincipledThin::anisotropic},
                                                     {"spec_tint", &PrincipledThin::spec_tint},
                                                     {"sheen", &PrincipledThin::sheen},
                                                     {"sheen_tint", &PrincipledThin::sheen_tint},
                                                     {"flatness", &PrincipledThin::flatness},
                                                     {"diff_trans", &PrincipledThin::diff_trans}};
  static constexpr std::uint8_t lobes =
      Lobe::reflection | Lobe::transmission | Lobe::diffuse | Lobe::glossy;

  PT_HD bool is_delta() const { return false; }

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& u) const {
    const float side = copysignf(1.0f, wo.z);
    const Vec3 o = side * wo;
    if (!(o.z > 0.0f)) return {};
    const float specular = spec_trans, mirror = mirror_part(o);
    const bool is_specular = u.z < specular;
    const float rest =
        is_specular ? divide(u.z, specular) : divide(u.z - specular, 1.0f - specular);
    const bool reflects = rest < (is_specular ? mirror : 1.0f - diffuse_transmission());
    Vec3 i;
    if (is_specular) {
      const Vec3 m = facets(reflects).sample_visible(o, u.x, u.y);
      const float cosine = dot(o, m);
      i = mirrored_by(o, m, cosine);
      if (!reflects && !transmits(m, i, cosine)) return {};
    } else {
      i = sample_cosine_hemisphere(u.x, u.y);
    }
    if (!(i.z > 0.0f)) return {};
    if (!reflects) i.z = -i.z;
    const BsdfValue value = evaluate(o, i);
    if (!(value.pdf > 0.0f)) return {};
    const int lobe = (reflects ? Lobe::reflection : Lobe::transmission) |
                     (is_specular ? Lobe::glossy : Lobe::diffuse);
    return {side * i, divide(value.f, value.pdf), value.pdf, static_cast<std::uint8_t>(lobe)};
  }

  PT_HD BsdfValue evaluate(const Vec3& wo, const Vec3& wi) const {
    const float side = copysignf(1.0f, wo.z);
    const Vec3 o = side * wo;
    Vec3 i = side * wi;
    const float z = i.z;
    if (!(o.z > 0.0f) || z == 0.0f) return {};
    const bool reflects = z > 0.0f;
    i.z = fabsf(z);
    const Vec3 m = normalize(o + i);
    const float cosine = fminf(dot(o, m), 1.0f);
    const float diffuse =
        (1.0f - spec_trans) * (reflects ? 1.0f - diffuse_transmission() : diffuse_transmission());
    Color f(0.0f);
    float pdf = diffuse * inverse_pi * i.z;
    if (diffuse > 0.0f) {
      f = (diffuse * i.z) *
          (reflects ? base().evaluate(o.z, i.z, cosine) : inverse_pi * base_color);
    }
    if (spec_trans > 0.0f && (reflects || transmits(m, i, cosine))) {
      const Microfacets rough = facets(reflects);
      const float lobe = 0.25f * rough.distribution(m) * rough.visible_over_cosine(o);
      const float mirror = mirror_part(o);
      pdf = fused_multiply_add(spec_trans * (reflects ? mirror : 1.0f - mirror), lobe, pdf);
      f = add_scaled(f, spec_trans * lobe * (rough.visible_over_cosine(i) * i.z),
                     reflectance(reflects, cosine));
    }
    return {f, pdf};
  }

 private:
  PT_HD PrincipledBase base() const { return {base_color, roughness, flatness, sheen, sheen_tint}; }

  /// The transmitted part of the diffuse light.
  PT_HD float diffuse_transmission() const { return 0.5f * diff_trans; }

  /// The lobe of transmitted light is wider, the higher the index of the sheet.
  PT_HD Microfacets facets(bool reflects) const {
    const float scale = reflects ? 1.0f : fused_multiply_add(0.65f, eta, -0.35f);
    return principled_facets(scale * roughness, anisotropic);
  }

  /// As in Mitsuba, a facet transmits light only if it faces away from the transmitted direction: i
  /// mirrored at the sheet, where dot(i, m) is `cosine`.
  PT_HD static bool transmits(const Vec3& m, const Vec3& i, float cosine) {
    return fused_multiply_add(-2.0f * m.z, i.z, cosine) < 0.0f;
  }

  /// The probability that a specular sample is reflected.
  PT_HD float mirror_part(const Vec3& o) const {
    return fminf(fmaxf(fresnel_dielectric(fminf(o.z, 1.0f), eta), 0.1f), 0.9f);
  }

  /// The colour of a specular lobe.
  PT_HD Color reflectance(bool reflects, float cosine) const {
    const float fresnel = fresnel_dielectric(cosine, eta);
    if (!reflects) return base_color * (1.0f - fresnel);
    const Color coloured = interpolate(hue(base_color) * normal_reflectance(eta), Color(1.0f),
                                       schlick_weight(cosine, eta));
    return interpolate(Color(fresnel), coloured, spec_tint);
  }
};

}  // namespace pt
