// Every BSDF of the list: sample() and evaluate() tell the same story.
#include <gtest/gtest.h>

#include <bit>

#include "material/bsdf_integral.h"

namespace pt {
namespace {

// A cell for each part of the sphere, and one for what is absorbed or goes into discrete
// directions.
TEST(BsdfSampling, FollowsTheDensity) {
  TestRandom random;
  const double sigmas = sidak_sigmas(all_bsdf_cases().size() * test_cosines.size());
  for_each_bsdf([&](const BsdfCase& one, const auto& bsdf, const Vec3& wo) {
    if (bsdf.is_delta()) return;
    const BsdfIntegral integral(bsdf, wo);
    const double total = integral.total_density() + integral.discrete_part();
    EXPECT_LE(total, 1.0015) << "the integral of the density";
    if (one.is_complete) {
      EXPECT_NEAR(total, 1, 1.5e-3) << "the integral of the density";
      EXPECT_EQ(integral.absorbed_part(), 0);
    }
    constexpr int count = 100'000;
    constexpr std::size_t rest = BsdfIntegral::cells;
    std::vector<double> counts(rest + 1);
    for (int i = 0; i < count; ++i) {
      const BsdfSample s = bsdf.sample(wo, random_numbers(random));
      const bool absorbed = is_black(s.weight) && s.pdf == 0.0f;
      ++counts[absorbed || s.is_delta() ? rest : integral.cell(s.wi)];
    }
    std::vector<double> expected = integral.density();
    for (double& e : expected) e *= count;
    expected.push_back(std::max(0.0, 1 - integral.total_density()) * count);
    // Quadrature is off by some 1e-3 where a lobe is cut at the horizon.
    EXPECT_NEAR(counts[rest], expected[rest], 1.5e-3 * count + 5 * std::sqrt(expected[rest]));
    expected[rest] = counts[rest];
    expect_counts(counts, expected, one.name, sigmas);
  });
}

TEST(BsdfSampling, WeightIsValueOverDensity) {
  TestRandom random;
  for_each_bsdf([&](const BsdfCase&, const auto& bsdf, const Vec3& wo) {
    int without_density = 0;
    constexpr int count = 20'000;
    for (int i = 0; i < count; ++i) {
      const BsdfSample s = bsdf.sample(wo, random_numbers(random));
      if (is_black(s.weight)) continue;
      ASSERT_NEAR(glm::length(Vec3d(s.wi)), 1, 1e-6);
      if (bsdf.is_delta()) {
        const BsdfValue value = bsdf.evaluate(wo, s.wi);
        ASSERT_TRUE(s.is_delta());
        ASSERT_EQ(value.pdf, 0.0f);
        ASSERT_TRUE(is_black(value.f));
      }
      if (s.is_delta()) continue;
      const BsdfValue value = bsdf.evaluate(wo, s.wi);
      if (value.pdf > 0) {
        ASSERT_NEAR(s.pdf, value.pdf, 1e-3 * (1 + s.pdf));
        for (int c = 0; c < 3; ++c) {
          ASSERT_NEAR(s.weight[c], value.f[c] / value.pdf, 1e-4 * (1 + s.weight[c]));
        }
      } else {
        ++without_density;  // by rounding at the edge of the lobe
      }
    }
    EXPECT_LE(without_density, count / 1000);
  });
}

// The lobe says on which side the direction lies, of one side and one kind; eta is 1 on this one.
TEST(BsdfSampling, SaysWhatASampleIs) {
  TestRandom random;
  const auto test = [&](const BsdfCase&, const auto& bsdf, const Vec3& wo) {
    for (int i = 0; i < 2000; ++i) {
      const BsdfSample s = bsdf.sample(wo, random_numbers(random));
      if (is_black(s.weight)) continue;
      const bool reflects = (s.lobe & Lobe::reflection) != 0;
      ASSERT_NE(reflects, (s.lobe & Lobe::transmission) != 0);
      ASSERT_EQ(reflects, same_side(wo, s.wi));
      const int kinds = s.lobe & (Lobe::diffuse | Lobe::glossy | Lobe::delta);
      ASSERT_EQ(std::popcount(static_cast<unsigned>(kinds)), 1);
      if (reflects) {
        ASSERT_EQ(s.eta, 1.0f);
      } else if (s.is_delta()) {  // Snell's law
        const double sine_o = std::hypot(wo.x, wo.y), sine_i = std::hypot(s.wi.x, s.wi.y);
        ASSERT_NEAR(sine_o, static_cast<double>(s.eta) * sine_i, 1e-5);
      }
    }
  };
  for_each_bsdf(test, true);
}

}  // namespace
}  // namespace pt
