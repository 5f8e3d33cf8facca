// A diffuse lobe and a glossy one, mixed: what Phong and Ward share.
#pragma once

#include "common/material/bsdf.h"
#include "common/sampling/warp.h"

namespace pt {

struct TwoLobes {
  Color diffuse, specular;

  /// Together they reflect at most what they get: scaled where their sum is above 1.
  PT_HD static TwoLobes make(const Color& diffuse, const Color& specular) {
    const float scale = divide(1.0f, fmaxf(max_abs(diffuse + specular), 1.0f));
    return {diffuse * scale, specular * scale};
  }

  /// The probability of sampling the glossy one.
  PT_HD float glossy_probability() const {
    const float s = mean(specular), sum = mean(diffuse) + s;
    return sum > 0.0f ? divide(s, sum) : 0.0f;
  }

  /// Of two directions on one side: `glossy_pdf` is the glossy lobe's density, `factor` its
  /// f |cos| / (specular glossy_pdf).
  PT_HD BsdfValue evaluate(const Vec3& wi, float glossy_pdf, float factor) const {
    const float p = glossy_probability();
    const float diffuse_pdf = cosine_hemisphere_pdf(fabsf(wi.z));
    return {add_scaled(multiply_rounded(diffuse, Color(diffuse_pdf)),
                       multiply_rounded(factor, glossy_pdf), specular),
            fused_multiply_add(p, glossy_pdf, multiply_rounded(1.0f - p, diffuse_pdf))};
  }

  /// A direction of the diffuse lobe, on the side of wo.
  PT_HD static Vec3 sample_diffuse(const Vec3& wo, const Vec3& u) {
    Vec3 wi = sample_cosine_hemisphere(u.x, u.y);
    if (wo.z < 0.0f) wi.z = -wi.z;
    return wi;
  }
};

/// The sample that `wi`, of unit length, is, by what `value` says of it.
PT_HD BsdfSample sample_of(const Vec3& wi, const BsdfValue& value, bool is_glossy) {
  if (!(value.pdf > 0.0f)) return {};
  const int kind = is_glossy ? Lobe::glossy : Lobe::diffuse;
  return {wi, value.f * divide(1.0f, value.pdf), value.pdf,
          static_cast<std::uint8_t>(Lobe::reflection | kind)};
}

}  // namespace pt
