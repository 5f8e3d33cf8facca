// The principled BSDF with the parameters and lobes of Mitsuba 3's `principled` (Burley 2012 and
// 2015, see principled_lobes.h): a diffuse base with sheen, a specular lobe that reflects as a
// metal or as a dielectric or transmits as glass, and a clearcoat. As the original, it does not
// conserve energy exactly. The probabilities with which lobes are sampled differ from Mitsuba's.
#pragma once

#include "common/material/bsdf.h"
#include "common/material/principled_lobes.h"

namespace pt {

struct Principled {
  static constexpr const char* name = "principled";
  Color base_color;       ///< in [0, 1]
  float roughness;        ///< in [0, 1]; alpha = roughness^2
  float metallic;         ///< in [0, 1]: dielectric to metal
  float spec_trans;       ///< in [0, 1]: opaque to glass
  float eta;              ///< index of refraction inside over outside, > 0
  float anisotropic;      ///< in [0, 1]: facets stretched along the tangent
  float spec_tint;        ///< in [0, 1]: white to coloured highlights of dielectrics
  float sheen;            ///< >= 0: scale of the grazing lobe of cloth
  float sheen_tint;       ///< in [0, 1]: white to coloured
  float flatness;         ///< in [0, 1]: diffuse to approximate subsurface scattering
  float clearcoat;        ///< >= 0: scale of the second lobe, of which 0.25 is used
  float clearcoat_gloss;  ///< in [0, 1]: alpha 0.1 to 0.001

  static constexpr Field<Principled> fields[] = {{"base_color", &Principled::base_color},
                                                 {"roughness", &Principled::roughness},
                                                 {"metallic", &Principled::metallic},
                                                 {"spec_trans", &Principled::spec_trans},
                                                 {"eta", &Principled::eta},
                                                 {"anisotropic", &Principled::anisotropic},
                                                 {"spec_tint", &Principled::spec_tint},
                                                 {"sheen", &Principled::sheen},
                                                 {"sheen_tint", &Principled::sheen_tint},
                                                 {"flatness", &Principled::flatness},
                                                 {"clearcoat", &Principled::clearcoat},
                                                 {"clearcoat_gloss", &Principled::clearcoat_gloss}};
  static constexpr std::uint8_t lobes =
      Lobe::reflection | Lobe::transmission | Lobe::diffuse | Lobe::glossy;

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
      // The rest of u.z decides whether the light is transmitted.
      const float rest = divide(u.z - choice.diffuse - choice.coat, choice.specular);
      if (!coats && rest < transmission_probability(view, fresnel_dielectric(cosine, view.eta))) {
        i = refracted(o, m, cosine, view.eta);
        lobe = Lobe::transmission | Lobe::glossy;
      }
    }
    const bool reflects = (lobe & Lobe::reflection) != 0;
    if (i.z == 0.0f || (i.z > 0.0f) != reflects) return {};
    const BsdfValue value = evaluate_in(view, choice, o, i);
    if (!(value.pdf > 0.0f)) return {};
    return {view.side * i, divide(value.f, value.pdf), value.pdf,
            lobe,          reflects ? 1.0f : view.eta, view.inside == reflects ? eta * eta : 1.0f};
  }

  PT_HD BsdfValue evaluate(const Vec3& wo, const Vec3& wi) const {
    const View view = view_of(wo);
    const Vec3 o = view.side * wo, i = view.side * wi;
    if (!(o.z > 0.0f) || i.z == 0.0f) return {};
    return evaluate_in(view, choice_at(view, o), o, i);
  }

 private:
  /// The viewer's side: mirrored so that the viewer is above the surface.
  struct View {
    float side;
    bool inside;  ///< in glass; opaque materials are the same on both sides
    float eta;    ///< beyond over before
  };

  /// Probabilities of the lobes.
  struct Choice {
    float diffuse, coat, specular;
  };

  PT_HD PrincipledBase base() const { return {base_color, roughness, flatness, sheen, sheen_tint}; }
  PT_HD float glass() const { return (1.0f - metallic) * spec_trans; }
  PT_HD float opaque() const { return (1.0f - metallic) * (1.0f - spec_trans); }
  PT_HD Microfacets facets() const { return principled_facets(roughness, anisotropic); }

  PT_HD View view_of(const Vec3& wo) const {
    const bool inside = wo.z < 0.0f && glass() > 0.0f;
    return {copysignf(1.0f, wo.z), inside, inside ? divide(1.0f, eta) : eta};
  }

  PT_HD Choice choice_at(const View& view, const Vec3& o) const {
    if (view.inside) return {0.0f, 0.0f, 1.0f};
    const float reflected = fmaxf(fresnel_dielectric(fminf(o.z, 1.0f), eta), 0.1f);
    const float specular = fused_multiply_add(opaque(), reflected - 1.0f, 1.0f);
    const float diffuse = opaque() * base().albedo(), coat = 0.25f * clearcoat;
    const float scale = divide(1.0f, diffuse + coat + specular);
    return {diffuse * scale, coat * scale, specular * scale};
  }

  /// The probability that a sample of the specular lobe is transmitted.
  PT_HD float transmission_probability(const View& view, float fresnel) const {
    return (view.inside ? 1.0f : glass()) * (1.0f - fresnel);
  }

  /// The specular lobe's reflectance.
  PT_HD Color reflectance(const View& view, float cosine, float fresnel) const {
    if (view.inside) return Color(glass() * fresnel);
    const float weight = schlick_weight(cosine, eta);
    const Color tinted = hue(base_color) * normal_reflectance(eta);
    const Color metal = interpolate(base_color, Color(1.0f), weight);
    const Color coloured = interpolate(tinted, Color(1.0f), weight);
    return interpolate(interpolate(Color(fresnel), coloured, spec_tint), metal, metallic);
  }

  PT_HD BsdfValue evaluate_in(const View& view, const Choice& choice, const Vec3& o,
                              const Vec3& i) const {
    const bool reflects = i.z > 0.0f;
    if (!reflects && glass() == 0.0f) return {};
    Vec3 m = normalize(add_scaled(o, reflects ? 1.0f : view.eta, i));
    if (m.z < 0.0f) m = -m;
    const float cos_o = fminf(dot(o, m), 1.0f), cos_i = dot(i, m);
    if (!(cos_o > 0.0f && (cos_i > 0.0f) == reflects)) return {};
    const float fresnel = fresnel_dielectric(cos_o, view.eta);
    const Microfacets rough = facets();
    const float dg1_o = rough.distribution(m) * rough.visible_over_cosine(o);
    const float g1_i = rough.visible_over_cosine(i) * fabsf(i.z);
    if (!reflects) {
      const float sum = fused_multiply_add(view.eta, cos_i, cos_o);
      const float lobe = divide(dg1_o * cos_o * -cos_i, sum * sum);
      const Color root(square_root(base_color.x), square_root(base_color.y),
                       square_root(base_color.z));
      return {root * (glass() * (1.0f - fresnel) * (lobe * g1_i)),
              choice.specular * transmission_probability(view, fresnel) *
                  (lobe * (view.eta * view.eta))};
    }
    const float lobe = 0.25f * dg1_o;
    Color f(0.0f);
    // As in Mitsuba, a metal with eta 1 reflects nothing either.
    if (eta != 1.0f) f = reflectance(view, cos_o, fresnel) * (lobe * g1_i);
    float pdf = choice.specular * (1.0f - transmission_probability(view, fresnel)) * lobe;
    if (!view.inside) {
      if (opaque() > 0.0f) {
        PrincipledBase below = base();
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
