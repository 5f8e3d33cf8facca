#include "common/scene/data/fit_polynomial.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pt {
namespace {

constexpr std::size_t terms = polynomial_terms;

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

}  // namespace

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

}  // namespace pt
