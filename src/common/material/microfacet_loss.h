// The energy that single scattering by microfacets of reflectance 1 loses: 1 - E, where E is the
// directional albedo of microfacet.h's facets. Single scattering ignores light that hits a second
// facet. E has no closed form: this is a fit for all roughnesses, within 0.0005 for GGX and 0.001
// for Beckmann.
#pragma once

#include "common/material/microfacet.h"

namespace pt {

/// Coefficients of polynomials, printed by scripts/fit_microfacet_loss.py.
struct MicrofacetLossFit {
  static constexpr int powers = 7, roughnesses = 6, averages = 4;
  float loss[powers][roughnesses];
  float log_average[averages], average[averages];
};

PT_HD constexpr MicrofacetLossFit ggx_loss_fit() {
  return {{{0.063512957f, -0.0072671864f, 0.83390097f, -0.92089323f, 0.61221296f, -0.19552156f},
           {0.39417885f, -0.25132526f, 2.2576119f, 2.2250355f, -3.3053612f, 1.1355557f},
           {0.16490699f, 3.6798437f, -14.471164f, -8.9834105f, 21.829113f, -11.681456f},
           {-5.4072101f, -16.064979f, 18.53681f, 194.50413f, -270.07979f, 121.22389f},
           {12.356434f, 32.308468f, 66.746522f, -763.06486f, 895.649f, -399.28772f},
           {-11.371116f, -31.783282f, -151.54898f, 928.89045f, -758.62066f, 425.70023f},
           {3.8424334f, 12.387442f, 82.784196f, -352.72577f, 180.94298f, -406.85953f}},
          {0.04373561f, 0.30056341f, 1.046013f, 3.1944341f},
          {0.037105461f, -0.3325444f, 0.071898001f, -0.01545023f}};
}

PT_HD constexpr MicrofacetLossFit beckmann_loss_fit() {
  return {{{0.033071482f, 0.056009423f, -0.21159567f, 0.62149842f, -0.72732882f, 0.30148294f},
           {0.42384137f, -1.4318928f, 10.169043f, -31.59775f, 44.864956f, -21.69759f},
           {-0.45350404f, 19.543362f, -77.833705f, 376.23494f, -712.47789f, 406.60844f},
           {-1.8874088f, -56.973995f, 54.639889f, -2064.8564f, 5582.0341f, -3612.6544f},
           {2.4546539f, 26.223553f, 761.81944f, 7886.3555f, -25107.157f, 16886.452f},
           {0.50746543f, 61.087473f, -1529.2358f, -18666.195f, 57273.504f, -37417.725f},
           {-1.0869429f, -51.205109f, 804.18055f, 14568.093f, -41374.412f, 24651.962f}},
          {-0.00011661003f, 0.037517023f, 0.58197859f, 3.7556767f},
          {0.03648872f, -0.33990609f, 0.093423395f, -0.033788156f}};
}

class MicrofacetLoss {
 public:
  /// `alpha` above 1 counts as 1.
  PT_HD static MicrofacetLoss make(float alpha, bool is_beckmann) {
    const float a = fminf(fmaxf(alpha, Microfacets::alpha_min), 1.0f);
    return is_beckmann ? MicrofacetLoss(beckmann_loss_fit(), a, a * a)
                       : MicrofacetLoss(ggx_loss_fit(), a, a);
  }

  /// The loss of light from a direction with this cosine, in [0, 1]. With t = cosine /
  /// sqrt(cosine^2 + k) and k = 16 alpha^2 it is 1 - t^2 times a polynomial in t and alpha
  /// (Beckmann: alpha^2).
  PT_HD float at(float cosine) const {
    const float part = 1.0f / fused_multiply_add(cosine, cosine, k_);
    const float t = cosine * sqrtf(part);
    float sum = terms_[MicrofacetLossFit::powers - 1];
    PT_UNROLL(8)
    for (int i = MicrofacetLossFit::powers - 2; i >= 0; --i) {
      sum = fused_multiply_add(sum, t, terms_[i]);
    }
    return fmaxf(k_ * part * sum, 0.0f);
  }

  /// The loss of diffuse light: the mean of at() over the square of the cosine.
  PT_HD float average() const { return average_; }

  /// A cosine, by a density that is nearly at() times the cosine: u uniform in [0, 1).
  PT_HD float sample_cosine(float u) const {
    return sqrtf(fminf(k_ * (expf(u * log_) - 1.0f), 1.0f));
  }
  /// Its density per solid angle; any azimuth is as likely.
  PT_HD float pdf(float cosine) const {
    return inverse_pi * cosine / (log_ * fused_multiply_add(cosine, cosine, k_));
  }

 private:
  PT_HD MicrofacetLoss(const MicrofacetLossFit& fit, float alpha, float y)
      : k_(16.0f * alpha * alpha), log_(logf(1.0f + 1.0f / k_)) {
    PT_UNROLL(8)
    for (int i = 0; i < MicrofacetLossFit::powers; ++i) terms_[i] = polynomial(fit.loss[i], y);
    const float with_log = polynomial(fit.log_average, alpha);
    average_ = k_ * fused_multiply_add(log_, with_log, polynomial(fit.average, alpha));
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
