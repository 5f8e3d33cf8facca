// Smooth plastic: a clear coat over a diffuse body. What the boundary lets through is scattered by
// the body, and the boundary reflects a part of that back inside, again and again (Mitsuba 3's
// `plastic`; the sum is that of Saunderson 1942).
#pragma once

#include "common/material/bsdf.h"
#include "common/material/fresnel.h"
#include "common/sampling/warp.h"

namespace pt {

/// The body under a coat, and how both share the samples.
struct CoatedBody {
  Color diffuse;   ///< the body's reflectance, in [0, 1]
  Color specular;  ///< multiplies what the coat reflects, in [0, 1]
  /// x: index of refraction inside over outside, > 0; y and z: the coat's internal reflectance for
  /// diffuse light. It is y where internal reflections do not colour the light (`nonlinear` is off
  /// in Mitsuba), else z; the other one is 0.
  Color coat;

  PT_HD float eta() const { return coat.x; }

  /// f of the body, with `entered` the transmittance of the coat on the way in times that on the
  /// way out, times the cosine over pi.
  PT_HD Color leaving(float entered) const {
    const float scale = divide(entered, coat.x * coat.x);
    const auto channel = [&](float d) {
      return divide(multiply_rounded(d, scale), fused_multiply_add(-coat.z, d, 1.0f - coat.y));
    };
    return {channel(diffuse.x), channel(diffuse.y), channel(diffuse.z)};
  }

  /// The probability of sampling the coat, which reflects the part `reflectance`.
  PT_HD float coat_probability(float reflectance) const {
    const float s = multiply_rounded(reflectance, mean(specular));
    const float sum = fused_multiply_add(1.0f - reflectance, mean(diffuse), s);
    return sum > 0.0f ? divide(s, sum) : 1.0f;
  }
};

struct Plastic {
  static constexpr const char* name = "plastic";
  /// Indices of the material's parameters.
  struct Index {
    enum : int {
      diffuse,   ///< the body's reflectance, in [0, 1]
      specular,  ///< multiplies what the coat reflects, in [0, 1]
      coat,      ///< see CoatedBody::coat
      count
    };
  };
  static constexpr int parameter_count = Index::count;
  static constexpr std::uint8_t lobes = Lobe::reflection | Lobe::diffuse | Lobe::delta;

  CoatedBody body;

  template <class Parameters>
  PT_HD static Plastic make(const Parameters& p) {
    return {{p.color(Index::diffuse), p.color(Index::specular), p.color(Index::coat)}};
  }

  PT_HD bool is_delta() const { return false; }

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& u) const {
    const float reflected = fresnel_dielectric(fminf(fabsf(wo.z), 1.0f), body.eta());
    const float p = body.coat_probability(reflected);
    if (u.z < p) {
      return {mirrored(wo), body.specular * divide(reflected, p), 0.0f,
              Lobe::reflection | Lobe::delta};
    }
    Vec3 wi = sample_cosine_hemisphere(u.x, u.y);
    const float passed = (1.0f - reflected) * (1.0f - fresnel_dielectric(wi.z, body.eta()));
    const float pdf = multiply_rounded(1.0f - p, cosine_hemisphere_pdf(wi.z));
    if (wo.z < 0.0f) wi.z = -wi.z;
    return {wi, body.leaving(divide(passed, 1.0f - p)), pdf, Lobe::reflection | Lobe::diffuse};
  }

  PT_HD BsdfValue evaluate(const Vec3& wo, const Vec3& wi) const {
    if (!same_side(wo, wi)) return {};
    const float reflected = fresnel_dielectric(fminf(fabsf(wo.z), 1.0f), body.eta());
    const float cosine = fminf(fabsf(wi.z), 1.0f);
    const float passed = (1.0f - reflected) * (1.0f - fresnel_dielectric(cosine, body.eta()));
    const float pdf = cosine_hemisphere_pdf(cosine);
    return {body.leaving(multiply_rounded(passed, pdf)),
            multiply_rounded(1.0f - body.coat_probability(reflected), pdf)};
  }
};

}  // namespace pt
