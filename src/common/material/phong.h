// The modified Phong model: a diffuse lobe and a power of the cosine around the mirror direction,
// reciprocal and bounded (Lafortune and Willems 1994, 'Using the Modified Phong Reflectance Model
// for Physically Based Rendering').
#pragma once

#include "common/material/two_lobes.h"
#include "common/math/transform.h"

namespace pt {

struct Phong {
  static constexpr const char* name = "phong";
  /// Indices of the material's parameters.
  struct Index {
    enum : int {
      diffuse,   ///< reflectance, in [0, 1]
      specular,  ///< reflectance, in [0, 1]
      exponent,  ///< >= 0
      count
    };
  };
  static constexpr int parameter_count = Index::count;
  static constexpr std::uint8_t lobes = Lobe::reflection | Lobe::diffuse | Lobe::glossy;

  TwoLobes two;
  float exponent;  ///< >= 0

  template <class Parameters>
  PT_HD static Phong make(const Parameters& p) {
    return {TwoLobes::make(p.color(Index::diffuse), p.color(Index::specular)),
            fmaxf(p.scalar(Index::exponent), 0.0f)};
  }

  PT_HD bool is_delta() const { return false; }

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& u) const {
    const bool glossy = u.z < two.glossy_probability();
    Vec3 wi = TwoLobes::sample_diffuse(wo, u);
    if (glossy) {
      const float cosine = power(1.0f - u.x, divide(1.0f, exponent + 1.0f));
      const float sine = fast_sqrt(fmaxf(0.0f, fused_multiply_add(-cosine, cosine, 1.0f)));
      const SinCos phi = sincos_2pi(u.y);
      const Frame frame = make_frame(mirrored(wo));
      wi = normalize(frame.to_world({sine * phi.cos, sine * phi.sin, cosine}));
    }
    return sample_of(wi, evaluate(wo, wi), glossy);
  }

  PT_HD BsdfValue evaluate(const Vec3& wo, const Vec3& wi) const {
    if (!same_side(wo, wi)) return {};
    const float lobe = power(dot(mirrored(wo), wi), exponent) * (0.5f * inverse_pi);
    // (n + 1) normalises the density, (n + 2) the reflectance at normal incidence.
    const float factor = divide(exponent + 2.0f, exponent + 1.0f) * fabsf(wi.z);
    return two.evaluate(wi, multiply_rounded(lobe, exponent + 1.0f), factor);
  }

 private:
  PT_HD static float power(float base, float to) {
    return base > 0.0f ? exp2f(to * log2f(fminf(base, 1.0f))) : 0.0f;
  }
};

}  // namespace pt
