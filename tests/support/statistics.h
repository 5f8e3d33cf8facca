// Tests of hypotheses. All limits are those of five standard deviations or rarer, and the random
// numbers of the tests are fixed, so that a failure is a finding.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "common/math/vec.h"

namespace pt {

inline constexpr double pi_double = 3.14159265358979323846;

/// Uniform numbers from a generator that is not under test.
class TestRandom {
 public:
  explicit TestRandom(std::uint64_t seed = 1) : engine_(seed) {}

  /// A multiple of 2^-24 in [0, 1), as the renderer draws them.
  float unit() { return static_cast<float>(engine_() >> 40) * 0x1p-24f; }
  double uniform(double lo, double hi) {
    return lo + (hi - lo) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  double log_uniform(double lo, double hi) { return std::exp(uniform(std::log(lo), std::log(hi))); }
  /// Uniform on the unit sphere.
  glm::dvec3 direction() {
    const double z = uniform(-1, 1), phi = uniform(0, 2 * pi_double), r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
  }
  /// In the cube [-size, size)^3.
  glm::dvec3 point(double size) {
    const double x = uniform(-size, size), y = uniform(-size, size);
    return {x, y, uniform(-size, size)};
  }
  std::uint32_t bits() { return static_cast<std::uint32_t>(engine_() >> 32); }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(engine_() % n); }

 private:
  std::mt19937_64 engine_;
};

/// Mean and its standard error.
class MeanEstimate {
 public:
  void add(double x) { ++n_, sum_ += x, sum2_ += x * x; }
  double mean() const { return sum_ / n_; }
  double sigma() const { return std::sqrt(std::max(0.0, sum2_ / n_ - mean() * mean()) / (n_ - 1)); }

 private:
  double n_ = 0, sum_ = 0, sum2_ = 0;
};

/// The limit, in standard deviations, that one of `tests` independent results exceeds with
/// probability `total` though all is well (Sidak 1967).
inline double sidak_sigmas(std::size_t tests, double total = 1e-3) {
  const double each = -std::expm1(std::log1p(-total) / static_cast<double>(tests));
  double low = 0, high = 10;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (0.5 * std::erfc(middle / std::sqrt(2.0)) > each ? low : high) = middle;
  }
  return high;
}

/// Pearson's chi-square test of counts against expected counts; cells with too few expected are
/// pooled. The limit is Wilson and Hilferty's (1931) for `sigmas` standard deviations.
inline void expect_counts(const std::vector<double>& counts, const std::vector<double>& expected,
                          const std::string& what, double sigmas = 5) {
  ASSERT_EQ(counts.size(), expected.size());
  double chi2 = 0, cells = 0, pooled_count = 0, pooled_expected = 0;
  const auto add = [&](double count, double mean) {
    chi2 += (count - mean) * (count - mean) / mean;
    ++cells;
  };
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (expected[i] >= 20) {
      add(counts[i], expected[i]);
    } else {
      pooled_count += counts[i], pooled_expected += expected[i];
    }
  }
  if (pooled_expected >= 5) {
    add(pooled_count, pooled_expected);
  } else {
    EXPECT_LE(pooled_count, 25) << what << ": samples where nearly none are expected";
  }
  if (cells < 2) return;
  const double dof = cells - 1, a = 2 / (9 * dof);
  EXPECT_LE(chi2, dof * std::pow(1 - a + sigmas * std::sqrt(a), 3))
      << what << ", " << dof << " dof";
}

/// As expect_counts, for a uniform distribution.
inline void expect_uniform(const std::vector<double>& counts, double total,
                           const std::string& what) {
  const std::vector<double> expected(counts.size(), total / static_cast<double>(counts.size()));
  expect_counts(counts, expected, what);
}

/// The cell of x in [0, 1] among `cells` equal ones.
inline std::size_t cell_of(double x, int cells) {
  return static_cast<std::size_t>(std::clamp(static_cast<int>(x * cells), 0, cells - 1));
}

}  // namespace pt
