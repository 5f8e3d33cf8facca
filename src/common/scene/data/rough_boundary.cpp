#include "common/scene/data/rough_boundary.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <tuple>
#include <vector>

#include "common/scene/data/fit_polynomial.h"

namespace pt {
namespace {

constexpr int nodes = 64;  // cosines

float cosine_of(int node) { return std::max(1e-6f, static_cast<float>(node) / (nodes - 1)); }

/// The mean of f(m) over the facets that a direction sees.
template <class Function>
double mean_over_facets(const Microfacets& facets, const Vec3& wi, int steps, const Function& f) {
  double sum = 0;
  for (int i = 0; i < steps * steps; ++i) {
    const float u0 = (static_cast<float>(i % steps) + 0.5f) / static_cast<float>(steps);
    const float u1 = (static_cast<float>(i / steps) + 0.5f) / static_cast<float>(steps);
    sum += static_cast<double>(f(facets.sample_visible(wi, u0, u1)));
  }
  return sum / (steps * steps);
}

float visible_part(const Microfacets& facets, const Vec3& w) {
  return w.z > 0.0f ? facets.visible_over_cosine(w) * w.z : 0.0f;
}

double transmittance(const Microfacets& facets, float eta, const Vec3& wi) {
  return mean_over_facets(facets, wi, 32, [&](const Vec3& m) {
    const float cosine = std::clamp(dot(wi, m), 0.0f, 1.0f);
    const float sine2 = (1.0f - cosine * cosine) / (eta * eta);
    if (sine2 >= 1.0f) return 0.0f;
    const float along = cosine / eta - std::sqrt(1.0f - sine2);
    const Vec3 below = wi / eta - along * m;  // mirrored into the upper half
    return (1.0f - fresnel_dielectric(cosine, eta)) * visible_part(facets, below);
  });
}

/// With more steps, for its edge: the angle of total reflection.
double reflectance(const Microfacets& facets, float eta, const Vec3& wi) {
  return mean_over_facets(facets, wi, 64, [&](const Vec3& m) {
    const float cosine = std::clamp(dot(wi, m), 0.0f, 1.0f);
    return fresnel_dielectric(cosine, eta) * visible_part(facets, mirrored_by(wi, m, cosine));
  });
}

RoughBoundary measure(float eta, float alpha, bool is_beckmann) {
  const Microfacets facets = Microfacets::make(alpha, alpha, is_beckmann);
  std::vector<double> x, passed;
  double reflected = 0;
  for (int node = 0; node < nodes; ++node) {
    const float cosine = cosine_of(node);
    const Vec3 wi(std::sqrt(1.0f - cosine * cosine), 0.0f, cosine);
    x.push_back(2 * std::sqrt(static_cast<double>(cosine)) - 1);
    passed.push_back(transmittance(facets, eta, wi));
    reflected += 2.0 / nodes * static_cast<double>(cosine) * reflectance(facets, 1.0f / eta, wi);
  }
  const Polynomial c = fit_polynomial(x, passed);
  RoughBoundary result;
  for (std::size_t i = 0; i < polynomial_terms; ++i)
    result.transmittance[i] = static_cast<float>(c[i]);
  result.internal_reflectance = static_cast<float>(std::min(reflected, 0.999));
  return result;
}

}  // namespace

RoughBoundary measure_rough_boundary(float eta, float alpha, bool is_beckmann) {
  static std::mutex mutex;
  static std::map<std::tuple<float, float, bool>, RoughBoundary> known;
  const std::lock_guard lock(mutex);
  const auto [entry, is_new] = known.try_emplace({eta, alpha, is_beckmann});
  if (is_new) entry->second = measure(eta, alpha, is_beckmann);
  return entry->second;
}

}  // namespace pt
