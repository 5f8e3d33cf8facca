// The principled BSDF of a thin sheet, a single surface, with the parameters and lobes of Mitsuba
// 3's `principledthin` (Burley 2015, see principled_lobes.h): the same on both sides; transmitted
// light is blurred by the roughness but not refracted.
#pragma once

#include "common/material/bsdf.h"
#include "common/material/principled_lobes.h"

namespace pt {

struct PrincipledThin {
  static constexpr const char* name = "thin principled";
  /// Indices of the material's parameters.
  struct Index {
    enum : int {
      base_color,   ///< in [0, 1]
      roughness,    ///< in [0, 1]; alpha = roughness^2
      spec_trans,   ///< in [0, 1]: opaque to clear
      eta,          ///< index of refraction of the sheet over that outside, > 0
      anisotropic,  ///< in [0, 1]: facets stretched along the tangent
      spec_tint,    ///< in [0, 1]: white to coloured highlights
      sheen,        ///< >= 0: scale of the grazing lobe of cloth
      sheen_tint,   ///< in [0, 1]: white to coloured
      flatness,     ///< in [0, 1]: diffuse to fake subsurface scattering
      diff_trans,   ///< in [0, 2]: 1 is half reflected, half transmitted
      count
    };
  };
  static constexpr int parameter_count = Index::count;
  static constexpr std::uint8_t lobes =
      Lobe::reflection | Lobe::transmission | Lobe::diffuse | Lobe::glossy;

  PrincipledBase base;
  float spec_trans;
  float eta;  ///< index of refraction of the sheet over that of what is outside, > 0
  float anisotropic, spec_tint;
  float diff_trans;  ///< transmitted part of the diffuse light, in [0, 1]: half the parameter

  template <class Parameters>
  PT_HD static PrincipledThin make(const Parameters& p) {
    return {{p.color(Index::base_color), p.scalar(Index::roughness), p.scalar(Index::flatness),
             p.scalar(Index::sheen), p.scalar(Index::sheen_tint)},
            p.scalar(Index::spec_trans),
            p.scalar(Index::eta),
            p.scalar(Index::anisotropic),
            p.scalar(Index::spec_tint),
            0.5f * p.scalar(Index::diff_trans)};
  }

  template <class Parameter>
  static bool uses_tangent(const Parameter* p) {
    return !is_black(p[Index::anisotropic].value);
  }

  PT_HD bool is_delta() const { return false; }

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& u) const {
    const float side = copysignf(1.0f, wo.z);
    const Vec3 o = side * wo;
    if (!(o.z > 0.0f)) return {};
    const float specular = spec_trans, mirror = mirror_part(o);
    const bool is_specular = u.z < specular;
    const float rest =
        is_specular ? divide(u.z, specular) : divide(u.z - specular, 1.0f - specular);
    const bool reflects = rest < (is_specular ? mirror : 1.0f - diff_trans);
    Vec3 i;
    if (is_specular) {
      const Vec3 m = facets(reflects).sample_visible(o, u.x, u.y);
      const float cosine = dot(o, m);
      i = mirrored_by(o, m, cosine);
      if (!reflects && !passes(m, i, cosine)) return {};
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
    const float diffuse = (1.0f - spec_trans) * (reflects ? 1.0f - diff_trans : diff_trans);
    Color f(0.0f);
    float pdf = multiply_rounded(diffuse * inverse_pi, i.z);
    if (diffuse > 0.0f) {
      f = (diffuse * i.z) * (reflects ? base.evaluate(o.z, i.z, cosine) : inverse_pi * base.color);
    }
    if (spec_trans > 0.0f && (reflects || passes(m, i, cosine))) {
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
  /// Light that passes is spread more, the more a sheet of this index would bend it.
  PT_HD Microfacets facets(bool reflects) const {
    const float scale = reflects ? 1.0f : fused_multiply_add(0.65f, eta, -0.35f);
    return principled_facets(scale * base.roughness, anisotropic);
  }

  /// As in Mitsuba, a facet that lets light pass must turn its back to where it goes: that is i
  /// mirrored at the sheet, where dot(i, m) is `cosine`.
  PT_HD static bool passes(const Vec3& m, const Vec3& i, float cosine) {
    return fused_multiply_add(-2.0f * m.z, i.z, cosine) < 0.0f;
  }

  /// How much of the specular light is taken to be reflected when lobes are chosen.
  PT_HD float mirror_part(const Vec3& o) const {
    return fminf(fmaxf(fresnel_dielectric(fminf(o.z, 1.0f), eta), 0.1f), 0.9f);
  }

  /// Of the specular lobes.
  PT_HD Color reflectance(bool reflects, float cosine) const {
    const float fresnel = fresnel_dielectric(cosine, eta);
    if (!reflects) return base.color * (1.0f - fresnel);
    const Color coloured = interpolate(hue(base.color) * normal_reflectance(eta), Color(1.0f),
                                       schlick_weight(cosine, eta));
    return interpolate(Color(fresnel), coloured, spec_tint);
  }
};

}  // namespace pt
