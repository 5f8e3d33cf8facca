#include "common/scene/data/plastic_material.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

namespace pt {

namespace {

Color packed(PlasticCoat coat, float internal_reflectance) {
  return {coat.eta, coat.nonlinear ? 0.0f : internal_reflectance,
          coat.nonlinear ? internal_reflectance : 0.0f};
}

}  // namespace

double diffuse_reflectance(double eta) {
  constexpr int steps = 4096;  // of the cosine's square, in which diffuse light is uniform
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double cosine = std::sqrt((i + 0.5) / steps);
    sum += static_cast<double>(
        fresnel_dielectric(static_cast<float>(cosine), static_cast<float>(eta)));
  }
  return sum / steps;
}

MaterialDescription make_plastic(const Color& diffuse, const Color& specular, PlasticCoat coat) {
  MaterialDescription m = make_material<Plastic>(diffuse);
  m[&Plastic::specular].value = specular;
  const double inside = diffuse_reflectance(1.0 / static_cast<double>(coat.eta));
  m[&Plastic::coat].value = packed(coat, static_cast<float>(inside));
  return m;
}

MaterialDescription make_rough_plastic(const Color& diffuse, const Color& specular,
                                       PlasticCoat coat, float alpha, bool is_beckmann) {
  const RoughBoundary boundary = measure_rough_boundary(coat.eta, alpha, is_beckmann);
  const auto& t = boundary.transmittance;
  MaterialDescription m = make_material<RoughPlastic>(diffuse);
  m[&RoughPlastic::specular].value = specular;
  m[&RoughPlastic::alpha].value = Color(alpha);
  m[&RoughPlastic::coat].value = packed(coat, boundary.internal_reflectance);
  m[&RoughPlastic::transmittance_0].value = {t[0], t[1], t[2]};
  m[&RoughPlastic::transmittance_1].value = {t[3], t[4], t[5]};
  m[&RoughPlastic::transmittance_2].value = {t[6], t[7], t[8]};
  m[&RoughPlastic::is_beckmann].value = Color(is_beckmann ? 1.0f : 0.0f);
  return m;
}

namespace {

constexpr std::size_t terms = RoughPlastic::terms;

using Polynomial = std::array<double, terms>;  ///< the constant first

double value_at(const Polynomial& c, double x) {
  double sum = 0;
  for (std::size_t i = terms; i-- > 0;) sum = sum * x + c[i];
  return sum;
}

/// Solves the symmetric system in place (Gauss, with pivots).
Polynomial solve(std::array<std::array<double, terms + 1>, terms>& rows) {
  for (std::size_t i = 0; i < terms; ++i) {
    std::size_t pivot = i;
    for (std::size_t r = i + 1; r < terms; ++r) {
      if (std::abs(rows[r][i]) > std::abs(rows[pivot][i])) pivot = r;
    }
    std::swap(rows[i], rows[pivot]);
    for (std::size_t r = 0; r < terms; ++r) {
      if (r == i) continue;
      const double factor = rows[r][i] / rows[i][i];
      for (std::size_t k = i; k <= terms; ++k) rows[r][k] -= factor * rows[i][k];
    }
  }
  Polynomial c;
  for (std::size_t i = 0; i < terms; ++i) c[i] = rows[i][terms] / rows[i][i];
  return c;
}

Polynomial fit(const std::vector<double>& x, const std::vector<double>& y,
               const std::vector<double>& weight) {
  std::array<std::array<double, terms + 1>, terms> rows{};
  for (std::size_t n = 0; n < x.size(); ++n) {
    std::array<double, terms + 1> powers{1};
    for (std::size_t i = 1; i < terms; ++i) powers[i] = powers[i - 1] * x[n];
    powers[terms] = y[n];
    for (std::size_t i = 0; i < terms; ++i) {
      for (std::size_t k = 0; k <= terms; ++k) rows[i][k] += weight[n] * powers[i] * powers[k];
    }
  }
  return solve(rows);
}

/// y(x), with the largest relative error as small as 40 rounds of least squares make it, whose
/// weights grow where the error is large (Lawson 1961). Values below 0.05 count as 0.05.
Polynomial fit_polynomial(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<double> weight(x.size()), error(x.size()), importance(x.size(), 1.0);
  Polynomial best{};
  for (int iteration = 0; iteration < 40; ++iteration) {
    const auto scale = [&](std::size_t n) { return 1.0 / std::max(y[n], 0.05); };
    for (std::size_t n = 0; n < x.size(); ++n) weight[n] = importance[n] * scale(n) * scale(n);
    best = fit(x, y, weight);
    for (std::size_t n = 0; n < x.size(); ++n) {
      error[n] = std::abs(value_at(best, x[n]) - y[n]) * scale(n);
    }
    const double largest = std::max(*std::max_element(error.begin(), error.end()), 1e-12);
    for (std::size_t n = 0; n < x.size(); ++n) importance[n] *= error[n] / largest + 0.02;
  }
  return best;
}

constexpr std::size_t nodes = 64;  // cosines

float cosine_of(std::size_t node) {
  return std::max(1e-6f, static_cast<float>(node) / static_cast<float>(nodes - 1));
}

/// The mean of f(m) over the normals m that are visible from a direction.
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

/// With more steps, because total reflection begins abruptly.
double reflectance(const Microfacets& facets, float eta, const Vec3& wi) {
  return mean_over_facets(facets, wi, 64, [&](const Vec3& m) {
    const float cosine = std::clamp(dot(wi, m), 0.0f, 1.0f);
    return fresnel_dielectric(cosine, eta) * visible_part(facets, mirrored_by(wi, m, cosine));
  });
}

RoughBoundary measure(float eta, float alpha, bool is_beckmann) {
  const Microfacets facets = Microfacets::make(alpha, alpha, is_beckmann);
  std::vector<double> x(nodes), passed(nodes), reflected_at(nodes);
  // Isolated: other work might want to measure, too, which one thread at a time does.
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(std::size_t{0}, nodes, [&](std::size_t node) {
      const float cosine = cosine_of(node);
      const Vec3 wi(std::sqrt(1.0f - cosine * cosine), 0.0f, cosine);
      x[node] = 2 * std::sqrt(static_cast<double>(cosine)) - 1;
      passed[node] = transmittance(facets, eta, wi);
      reflected_at[node] = 2.0 / static_cast<double>(nodes) * static_cast<double>(cosine) *
                           reflectance(facets, 1.0f / eta, wi);
    });
  });
  const double reflected = std::accumulate(reflected_at.begin(), reflected_at.end(), 0.0);
  const Polynomial c = fit_polynomial(x, passed);
  RoughBoundary result;
  for (std::size_t i = 0; i < terms; ++i) result.transmittance[i] = static_cast<float>(c[i]);
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
