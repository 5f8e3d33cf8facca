// The direction in which a path continues: by BSDF sampling or, for comparison, uniform or
// cosine-weighted over the hemisphere (--sampling).
#pragma once

#include "common/choices/choices.h"
#include "common/material/bsdf.h"
#include "common/sampling/warp.h"

namespace pt {

/// Densities of uniform or cosine-weighted directions on the sides on which the BSDF scatters.
/// Delta lobes can be sampled by the BSDF alone, which gets half of the samples where there are
/// other lobes, too.
template <class Bsdf>
struct PlainDirections {
  static constexpr bool transmits = (Bsdf::lobes & Lobe::transmission) != 0;
  static constexpr bool mirrors = (Bsdf::lobes & Lobe::delta) != 0;
  static constexpr float share = (mirrors ? 0.5f : 1.0f) * (transmits ? 0.5f : 1.0f);

  PT_HD static float pdf(DirectionSampling how, const Vec3& wo, const Vec3& wi) {
    if (!transmits && !same_side(wo, wi)) return 0.0f;
    const float density =
        how == DirectionSampling::cosine ? cosine_hemisphere_pdf(fabsf(wi.z)) : unit_hemisphere_pdf;
    return density * share;
  }

  PT_HD static Vec3 sample(DirectionSampling how, const Vec3& wo, const Vec3& u) {
    Vec3 wi = how == DirectionSampling::cosine ? sample_cosine_hemisphere(u.x, u.y)
                                               : sample_unit_sphere(u.x, u.y);
    wi.z = fabsf(wi.z);
    const bool below = transmits ? u.z < 0.5f : wo.z < 0.0f;
    return {wi.x, wi.y, below ? -wi.z : wi.z};
  }
};

/// A uniform or cosine-weighted direction. Not inlined, and by value: the code of a comparison
/// that is seldom made, a second sample() and evaluate(), does not lie between that of every path.
template <class Bsdf>
PT_NOINLINE BsdfSample sample_plainly(Bsdf bsdf, DirectionSampling how, Vec3 wo, Vec3 u) {
  using Plain = PlainDirections<Bsdf>;
  if constexpr (Plain::mirrors) {
    if (u.z < 0.5f) {
      BsdfSample mirror = bsdf.sample(wo, {u.x, u.y, 2.0f * u.z});
      mirror.weight = mirror.is_delta() ? 2.0f * mirror.weight : Color(0.0f);
      return mirror;
    }
    u.z = 2.0f * u.z - 1.0f;
  }
  const Vec3 wi = Plain::sample(how, wo, u);
  const float pdf = Plain::pdf(how, wo, wi);
  if (!(pdf > 0.0f)) return {};
  return {wi, bsdf.evaluate(wo, wi).f / pdf, pdf, Lobe::glossy};
}

/// `u` uniform in [0, 1)^3.
template <class Bsdf>
PT_HD BsdfSample sample_direction(const Bsdf& bsdf, DirectionSampling how, const Vec3& wo,
                                  const Vec3& u) {
  if (how == DirectionSampling::bsdf || bsdf.is_delta()) return bsdf.sample(wo, u);
  return sample_plainly(bsdf, how, wo, u);
}

/// The density of the above, given that of the BSDF's own sample().
template <class Bsdf>
PT_HD float direction_pdf(const Bsdf&, DirectionSampling how, const Vec3& wo, const Vec3& wi,
                          float bsdf_pdf) {
  return how == DirectionSampling::bsdf ? bsdf_pdf : PlainDirections<Bsdf>::pdf(how, wo, wi);
}

}  // namespace pt
