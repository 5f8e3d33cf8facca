// The principled BSDF with the parameters and lobes of Mitsuba 3's `principled` (Burley 2012 and
// 2015, see principled_lobes.h): a diffuse base with sheen, a specular lobe that reflects as a
// metal or as a dielectric or transmits as glass, and a clearcoat. As the original, it does not
// conserve energy exactly. The probabilities with which lobes are sampled differ from Mitsuba's.
#pragma once

#include "common/material/bsdf.h"
#include "common/material/clearcoat.h"
#include "common/material/principled_lobes.h"

namespace pt {

struct Principled {
  static constexpr const char* name = "principled";
  /// Indices of the material's parameters.
  struct Index {
    enum : int {
      base_color,       ///< in [0, 1]
      roughness,        ///< in [0, 1]; alpha = roughness^2
      metallic,         ///< in [0, 1]: dielectric to metal
      spec_trans,       ///< in [0, 1]: opaque to glass
      eta,              ///< index of refraction inside over outside, > 0
      anisotropic,      ///< in [0, 1]: facets stretched along the tangent
      spec_tint,        ///< in [0, 1]: white to coloured highlights of dielectrics
      sheen,            ///< >= 0: scale of the grazing lobe of cloth
      sheen_tint,       ///< in [0, 1]: white to coloured
      flatness,         ///< in [0, 1]: diffuse to fake subsurface scattering
      clearcoat,        ///< >= 0: scale of the second lobe, of which 0.25 is used
      clearcoat_gloss,  ///< in [0, 1]: alpha 0.1 to 0.001
      count
    };
  };
  static constexpr int parameter_count = Index::count;
  static constexpr std::uint8_t lobes =
      Lobe::reflection | Lobe::transmission | Lobe::diffuse | Lobe::glossy;

  PrincipledBase base;
  // Units and ranges: see Index.
  float metallic, spec_trans, eta, anisotropic, spec_tint, clearcoat, clearcoat_gloss;

  template <class Parameters>
  PT_HD static Principled make(const Parameters& p) {
    return {{p.color(Index::base_color), p.scalar(Index::roughness), p.scalar(Index::flatness),
             p.scalar(Index::sheen), p.scalar(Index::sheen_tint)},
            p.scalar(Index::metallic),
            p.scalar(Index::spec_trans),
            p.scalar(Index::eta),
            p.scalar(Index::anisotropic),
            p.scalar(Index::spec_tint),
            p.scalar(Index::clearcoat),
            p.scalar(Index::clearcoat_gloss)};
  }

  template <class Parameter>
  static bool uses_tangent(const Parameter* p) {
    return !is_black(p[Index::anisotropic].value);
  }

  PT_HD bool is_delta() const { return false; }

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& u) const {
    const View view = view_of(wo);
    const Vec3 o = view.side * wo;
    if (!(o.z > 0.0f)) return {};
    const Choice choice = choice_at(view, o);
    Vec3 i;
    std::uint8_t lobe = Lobe::reflection | Lobe::glossy;
    if (u.z < choice.diffuse) {
      i = sample_cosine_hemisphere(u.x, u.y);
      lobe = Lobe::reflection | Lobe::diffuse;
    } else {
      const bool coats = u.z < choice.diffuse + choice.coat;
      const Vec3 m = coats ? Clearcoat::make(clearcoat_gloss).sample(u.x, u.y)
                           : facets().sample_visible(o, u.x, u.y);
      const float cosine = fminf(dot(o, m), 1.0f);
      if (!(cosine > 0.0f)) return {};
      i = mirrored_by(o, m, cosine);
      // What is left of u.z decides whether the light passes.
      const float rest = divide(u.z - choice.diffuse - choice.coat, choice.specular);
      if (!coats && rest < passing(view, fresnel_dielectric(cosine, view.eta))) {
        i = refracted(o, m, cosine, view.eta);
        lobe = Lobe::transmission | Lobe::glossy;
      }
    }
    const bool reflects = (lobe & Lobe::reflection) != 0;
    if (i.z == 0.0f || (i.z > 0.0f) != reflects) return {};
    const BsdfValue value = evaluate_seen(view, choice, o, i);
    if (!(value.pdf > 0.0f)) return {};
    return {view.side * i, divide(value.f, value.pdf), value.pdf,
            lobe,          reflects ? 1.0f : view.eta, view.inside == reflects ? eta * eta : 1.0f};
  }

  PT_HD BsdfValue evaluate(const Vec3& wo, const Vec3& wi) const {
    const View view = view_of(wo);
    const Vec3 o = view.side * wo, i = view.side * wi;
    if (!(o.z > 0.0f) || i.z == 0.0f) return {};
    return evaluate_seen(view, choice_at(view, o), o, i);
  }

 private:
  /// The viewer's side: mirrored so that the viewer is above the surface.
  struct View {
    float side;
    bool inside;  ///< of glass; opaque materials are the same on both sides
    float eta;    ///< beyond over before
  };

  /// Probabilities of the lobes.
  struct Choice {
    float diffuse, coat, specular;
  };

  PT_HD float glass() const { return (1.0f - metallic) * spec_trans; }
  PT_HD float opaque() const { return (1.0f - metallic) * (1.0f - spec_trans); }
  PT_HD Microfacets facets() const { return principled_facets(base.roughness, anisotropic); }

  PT_HD View view_of(const Vec3& wo) const {
    const bool inside = wo.z < 0.0f && glass() > 0.0f;
    return {copysignf(1.0f, wo.z), inside, inside ? divide(1.0f, eta) : eta};
  }

  PT_HD Choice choice_at(const View& view, const Vec3& o) const {
    if (view.inside) return {0.0f, 0.0f, 1.0f};
    const float reflected = fmaxf(fresnel_dielectric(fminf(o.z, 1.0f), eta), 0.1f);
    const float specular = fused_multiply_add(opaque(), reflected - 1.0f, 1.0f);
    const float diffuse = opaque() * base.albedo(), coat = 0.25f * clearcoat;
    const float scale = divide(1.0f, diffuse + coat + specular);
    return {diffuse * scale, coat * scale, specular * scale};
  }

  /// The probability that a sample of the specular lobe is transmitted.
  PT_HD float passing(const View& view, float fresnel) const {
    return (view.inside ? 1.0f : glass()) * (1.0f - fresnel);
  }

  /// The specular lobe's reflectance.
  PT_HD Color reflectance(const View& view, float cosine, float fresnel) const {
    if (view.inside) return Color(glass() * fresnel);
    const float weight = schlick_weight(cosine, eta);
    const Color tinted = hue(base.color) * normal_reflectance(eta);
    const Color metal = interpolate(base.color, Color(1.0f), weight);
    const Color coloured = interpolate(tinted, Color(1.0f), weight);
    return interpolate(interpolate(Color(fresnel), coloured, spec_tint), metal, metallic);
  }

  PT_HD BsdfValue evaluate_seen(const View& view, const Choice& choice, const Vec3& o,
                                const Vec3& i) const {
    const bool reflects = i.z > 0.0f;
    if (!reflects && glass() == 0.0f) return {};
    Vec3 m = normalize(add_scaled(o, reflects ? 1.0f : view.eta, i));
    if (m.z < 0.0f) m = -m;
    const float cos_o = fminf(dot(o, m), 1.0f), cos_i = dot(i, m);
    if (!(cos_o > 0.0f && (cos_i > 0.0f) == reflects)) return {};
    const float fresnel = fresnel_dielectric(cos_o, view.eta);
    const Microfacets rough = facets();
    const float seen = rough.distribution(m) * rough.visible_over_cosine(o);
    const float shown = rough.visible_over_cosine(i) * fabsf(i.z);
    if (!reflects) {
      const float sum = fused_multiply_add(view.eta, cos_i, cos_o);
      const float lobe = divide(seen * cos_o * -cos_i, sum * sum);
      const Color root(square_root(base.color.x), square_root(base.color.y),
                       square_root(base.color.z));
      return {
          root * (glass() * (1.0f - fresnel) * (lobe * shown)),
          multiply_rounded(choice.specular * passing(view, fresnel), lobe * (view.eta * view.eta))};
    }
    const float lobe = 0.25f * seen;
    Color f(0.0f);
    // Mitsuba's metal, too, ends where a dielectric would reflect nothing.
    if (eta != 1.0f) f = reflectance(view, cos_o, fresnel) * (lobe * shown);
    float pdf = multiply_rounded(choice.specular * (1.0f - passing(view, fresnel)), lobe);
    if (!view.inside) {
      if (opaque() > 0.0f) {
        PrincipledBase below = base;
        // Sheen is scaled by 1 - metallic but not by 1 - spec_trans.
        below.color *= opaque(), below.sheen *= 1.0f - metallic;
        f = add_scaled(f, i.z, below.evaluate(o.z, i.z, cos_o));
        pdf = fused_multiply_add(choice.diffuse * inverse_pi, i.z, pdf);
      }
      if (clearcoat > 0.0f) {
        const float coat = Clearcoat::make(clearcoat_gloss).distribution(m);
        const float schlick = interpolate(0.04f, 1.0f, schlick_weight(cos_o, eta));
        f = add_scaled(f, 0.25f * clearcoat * schlick * coat,
                       Color(Clearcoat::visible(o, i) * i.z));
        pdf = fused_multiply_add(choice.coat * coat, divide(0.25f * m.z, cos_o), pdf);
      }
    }
    return {f, pdf};
  }
};

}  // namespace pt
