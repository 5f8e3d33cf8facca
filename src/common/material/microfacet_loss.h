// What single scattering by microfacets of reflectance 1 loses: 1 - E, where E is the directional
// albedo, for the facets of microfacet.h of one roughness. Light that meets a second facet is
// counted as lost there. A fit for all roughnesses (scripts/fit_microfacet_loss.py); E has no
// closed form. Within 0.0005 for GGX, 0.001 for Beckmann.
#pragma once

#include "common/material/microfacet.h"
#include "common/material/microfacet_loss_fit.h"

namespace pt {

class MicrofacetLoss {
 public:
  /// `alpha` above 1 counts as 1.
  PT_HD static MicrofacetLoss make(float alpha, bool is_beckmann) {
    const float a = fminf(fmaxf(alpha, Microfacets::alpha_min), 1.0f);
    return is_beckmann ? MicrofacetLoss(beckmann_loss_fit(), a, a * a)
                       : MicrofacetLoss(ggx_loss_fit(), a, a);
  }

  /// Of light from a direction with this cosine, in [0, 1]. With t = cosine / sqrt(cosine^2 + k)
  /// and k = 16 alpha^2 it is 1 - t^2 times a polynomial in t and alpha (Beckmann: alpha^2).
  PT_HD float at(float cosine) const {
    const float part = 1.0f / fused_multiply_add(cosine, cosine, k_);
    const float t = multiply_rounded(cosine, sqrtf(part));
    float sum = terms_[MicrofacetLossFit::powers - 1];
    PT_UNROLL(8)
    for (int i = MicrofacetLossFit::powers - 2; i >= 0; --i) {
      sum = fused_multiply_add(sum, t, terms_[i]);
    }
    return fmaxf(multiply_rounded(k_ * part, sum), 0.0f);
  }

  /// The mean of at() over the cosine's square: of light from all directions.
  PT_HD float average() const { return average_; }

  /// A cosine, by a density that is nearly at() times the cosine: u uniform in [0, 1).
  PT_HD float sample_cosine(float u) const {
    return sqrtf(fminf(multiply_rounded(k_, expf(multiply_rounded(u, log_)) - 1.0f), 1.0f));
  }
  /// Its density per solid angle; any azimuth is as likely.
  PT_HD float pdf(float cosine) const {
    return inverse_pi * cosine / multiply_rounded(log_, fused_multiply_add(cosine, cosine, k_));
  }

 private:
  PT_HD MicrofacetLoss(const MicrofacetLossFit& fit, float alpha, float y)
      : k_(multiply_rounded(16.0f * alpha, alpha)), log_(logf(1.0f + 1.0f / k_)) {
    PT_UNROLL(8)
    for (int i = 0; i < MicrofacetLossFit::powers; ++i) terms_[i] = polynomial(fit.loss[i], y);
    const float with_log = polynomial(fit.log_average, alpha);
    average_ =
        multiply_rounded(k_, fused_multiply_add(log_, with_log, polynomial(fit.average, alpha)));
  }

  template <int terms>
  PT_HD static float polynomial(const float (&coefficients)[terms], float x) {
    float sum = coefficients[terms - 1];
    PT_UNROLL(8)
    for (int i = terms - 2; i >= 0; --i) sum = fused_multiply_add(sum, x, coefficients[i]);
    return sum;
  }

  float k_, log_, average_;
  float terms_[MicrofacetLossFit::powers];
};

}  // namespace pt
