#include "common/scene/prepare/prepare_filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error/error.h"
#include "common/options/option_names.h"

namespace pt {
namespace {

constexpr int steps = 1 << 16;  // of the integration over one side

/// One side of a filter, integrated step by step.
struct Integral {
  std::vector<double> absolute = {0};  ///< [k]: of |f| over [0, k / steps * radius]
  double sum = 0;                      ///< of f
  std::vector<double> changes;         ///< of |f|, up to where f changes its sign
};

/// By the midpoint rule: its error is below 1e-9 of the whole for all filters here.
Integral integrate(const FilterChoice& filter) {
  Integral integral;
  const double step = filter_radius(filter) / steps;
  bool negative = false;
  for (int i = 0; i < steps; ++i) {
    const double f = filter_value(filter, (i + 0.5) * step) * step;
    integral.sum += f;
    integral.absolute.push_back(integral.absolute.back() + std::abs(f));
    if (f != 0 && (f < 0) != negative) {
      negative = !negative;
      integral.changes.push_back(*(integral.absolute.end() - 2));
    }
  }
  return integral;
}

/// Where the integral of |f| reaches k cells' share of the whole.
std::vector<float> quantiles_of(const std::vector<double>& absolute, double radius) {
  std::vector<float> quantiles;
  std::size_t i = 0;
  for (int k = 0; k <= PixelFilter::cells; ++k) {
    const double wanted = absolute.back() * k / PixelFilter::cells;
    while (i + 2 < absolute.size() && absolute[i + 1] < wanted) ++i;
    const double mass = absolute[i + 1] - absolute[i];
    const double part = mass > 0 ? std::clamp((wanted - absolute[i]) / mass, 0.0, 1.0) : 0.0;
    quantiles.push_back(static_cast<float>((static_cast<double>(i) + part) * radius / steps));
  }
  return quantiles;
}

}  // namespace

double filter_radius(const FilterChoice& filter) { return filter_info(filter.kind).radius(filter); }

double filter_value(const FilterChoice& filter, double x) {
  x = std::abs(x);
  return x > filter_radius(filter) ? 0 : filter_info(filter.kind).value(filter, x);
}

FilterChoice default_filter(FilterKind kind) {
  return {kind, filter_info(kind).a, filter_info(kind).b};
}

FilterChoice filter_of(const Options& options, const SceneData& scene) {
  return options.filter.value_or(scene.defaults.filter.value_or(FilterChoice{}));
}

void prepare_filter(SceneData& scene, const FilterChoice& filter) {
  scene.filter = {};
  scene.filter_quantiles.clear();
  if (filter == FilterChoice{}) return;
  const Integral side = integrate(filter);
  // Integrals of f(x) f(y) and of its absolute value over the plane.
  const double sum = side.sum * side.sum, all = side.absolute.back() * side.absolute.back();
  if (!(side.sum > 0.1 * side.absolute.back()) || side.changes.size() > PixelFilter::changes_max) {
    throw Error(
        fmt::format("--filter {}:{}:{}: expected a filter whose positive part is by far "
                    "the larger one, with at most {} changes of sign",
                    to_string(filter.kind), filter.a, filter.b, PixelFilter::changes_max));
  }
  scene.filter.has_table = 1;
  scene.filter.change_count = static_cast<std::uint32_t>(side.changes.size());
  std::transform(side.changes.begin(), side.changes.end(), scene.filter.sign_changes,
                 [&](double x) { return static_cast<float>(x / side.absolute.back()); });
  scene.filter.positive_weight = static_cast<float>(0.5 * (all + sum) / sum);
  scene.filter.negative_weight = static_cast<float>(0.5 * (all - sum) / sum);
  scene.filter_quantiles = quantiles_of(side.absolute, filter_radius(filter));
}

}  // namespace pt
