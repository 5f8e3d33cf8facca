// Every BSDF of the list against the contract of bsdf.h.
#include <gtest/gtest.h>

#include <bit>
#include <set>
#include <string>

#include "bsdf_cases.h"
#include "statistics.h"

namespace pt {
namespace {

using Vec3d = glm::dvec3;

/// Calls test(case, bsdf, wo) for every case and for directions from the normal to grazing, on both
/// sides of the surface.
template <class Test>
void for_each_bsdf(const Test& test) {
  for (const BsdfCase& one : all_bsdf_cases()) {
    SCOPED_TRACE(one.name);
    for (const double cosine : {1.0, 0.7, 0.2, 0.02, -0.02, -0.4, -1.0}) {
      SCOPED_TRACE(testing::Message() << "cos(wo) = " << cosine);
      const double sine = std::sqrt(1 - cosine * cosine);
      const Vec3 wo(0.6 * sine, -0.8 * sine, cosine);
      visit(one.material.kind, one.material, [&](const auto& bsdf) { test(one, bsdf, wo); });
    }
  }
}

Vec3 random_numbers(TestRandom& random) { return {random.unit(), random.unit(), random.unit()}; }

// A grid around the mirror direction, finer near it, with an additional cell for what is absorbed.
constexpr int rings = 24, sectors = 24, absorbed = rings * sectors;

struct Grid {
  explicit Grid(const Vec3& wo) : pole(mirrored(wo)) {
    pole = glm::normalize(pole);
    x = glm::normalize(glm::cross(std::abs(pole.x) > 0.5 ? Vec3d(0, 1, 0) : Vec3d(1, 0, 0), pole));
    y = glm::cross(pole, x);
  }
  std::size_t cell(const Vec3& wi) const {
    const Vec3d w(wi);
    const double theta = std::acos(std::clamp(glm::dot(w, pole), -1.0, 1.0));
    const double phi = std::atan2(glm::dot(w, y), glm::dot(w, x));
    return sectors * cell_of(std::sqrt(theta / pi_double), rings) +
           cell_of(phi / (2 * pi_double) + 0.5, sectors);
  }
  /// Integrals of `f` over the cells.
  template <class F>
  std::vector<double> integrate(const F& f) const {
    constexpr int steps = 64, turns = 12;  // per cell, in each angle
    std::vector<double> sums(rings * sectors + 1);
    for (int i = 0; i < rings * steps; ++i) {
      const double s = (i + 0.5) / (rings * steps), theta = pi_double * s * s;
      const double d_theta = 2 * pi_double * s / (rings * steps);
      const double weight = std::sin(theta) * d_theta * 2 * pi_double / (sectors * turns);
      for (int k = 0; k < sectors * turns; ++k) {
        const double phi = ((k + 0.5) / (sectors * turns) - 0.5) * 2 * pi_double;
        const Vec3d w =
            std::cos(theta) * pole + std::sin(theta) * (std::cos(phi) * x + std::sin(phi) * y);
        sums[static_cast<std::size_t>(i / steps * sectors + k / turns)] += weight * f(Vec3(w));
      }
    }
    return sums;
  }
  Vec3d pole, x, y;
};

TEST(Bsdf, SamplesFollowTheDensity) {
  TestRandom random;
  for_each_bsdf([&](const BsdfCase& sample, const auto& bsdf, const Vec3& wo) {
    if (bsdf.is_delta()) return;
    const Grid grid(wo);
    constexpr int count = 100'000;
    std::vector<double> counts(rings * sectors + 1);
    for (int i = 0; i < count; ++i) {
      const BsdfSample s = bsdf.sample(wo, random_numbers(random));
      ++counts[is_black(s.weight) ? absorbed : grid.cell(s.wi)];
    }
    std::vector<double> expected =
        grid.integrate([&](const Vec3& wi) { return bsdf.evaluate(wo, wi).pdf; });
    double total = 0;
    for (double& e : expected) total += e, e *= count;
    EXPECT_LE(total, 1.001) << "the density's integral";
    expected[absorbed] = std::max(0.0, 1 - total) * count;
    EXPECT_NEAR(counts[absorbed], expected[absorbed],
                2e-3 * count + 5 * std::sqrt(expected[absorbed]));
    expect_counts(counts, expected, sample.name);
  });
}

TEST(Bsdf, SampledWeightIsValueOverDensity) {
  TestRandom random;
  for_each_bsdf([&](const BsdfCase&, const auto& bsdf, const Vec3& wo) {
    int without_density = 0;
    constexpr int count = 20'000;
    for (int i = 0; i < count; ++i) {
      const BsdfSample s = bsdf.sample(wo, random_numbers(random));
      if (is_black(s.weight)) continue;
      ASSERT_NEAR(glm::length(Vec3d(s.wi)), 1, 1e-6);
      const BsdfValue value = bsdf.evaluate(wo, s.wi);
      ASSERT_EQ(s.is_delta(), bsdf.is_delta());
      if (bsdf.is_delta()) {
        ASSERT_EQ(value.pdf, 0.0f);
        ASSERT_TRUE(is_black(value.f));
      } else if (value.pdf > 0) {
        ASSERT_NEAR(s.pdf, value.pdf, 1e-5 * (1 + s.pdf));
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(s.weight[c], value.f[c] / value.pdf, 1e-5);
      } else {
        ++without_density;  // by rounding at the edge of the lobe
      }
    }
    EXPECT_LE(without_density, count / 1000);
  });
}

// The lobe says on which side the direction lies, of one side and one kind; eta is 1 on this one.
TEST(Bsdf, SamplesSayWhatTheyAre) {
  TestRandom random;
  for_each_bsdf([&](const BsdfCase&, const auto& bsdf, const Vec3& wo) {
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
      } else {  // Snell's law
        const double sine_o = std::hypot(wo.x, wo.y), sine_i = std::hypot(s.wi.x, s.wi.y);
        ASSERT_NEAR(sine_o, static_cast<double>(s.eta) * sine_i, 1e-5);
      }
    }
  });
}

TEST(Bsdf, IsReciprocal) {
  TestRandom random;
  for_each_bsdf([&](const BsdfCase& sample, const auto& bsdf, const Vec3& wo) {
    if (!sample.is_reciprocal) return;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 wi(random.direction());
      const Color there = bsdf.evaluate(wo, wi).f / std::abs(wi.z);
      const Color back = bsdf.evaluate(wi, wo).f / std::abs(wo.z);
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(there[c], back[c], 1e-5 * (there[c] + back[c]));
    }
  });
}

TEST(Bsdf, NeverCreatesEnergy) {
  TestRandom random;
  for_each_bsdf([&](const BsdfCase&, const auto& bsdf, const Vec3& wo) {
    for (int i = 0; i < 5000; ++i) {
      const BsdfSample s = bsdf.sample(wo, random_numbers(random));
      // Radiance over the square of the index of refraction is what does not grow on its way.
      const Color w = s.weight * (s.eta * s.eta);
      ASSERT_TRUE(w.x >= 0 && w.y >= 0 && w.z >= 0);
      ASSERT_LE(std::max({w.x, w.y, w.z}), 1 + 1e-6) << "no kind so far weighs above 1";
    }
    if (bsdf.is_delta()) return;
    double albedo = 0;
    for (const double part : Grid(wo).integrate([&](const Vec3& wi) {
           const Color f = bsdf.evaluate(wo, wi).f;
           return std::max({f.x, f.y, f.z});
         })) {
      albedo += part;
    }
    EXPECT_LE(albedo, 1.001);
  });
}

TEST(Diffuse, ReflectsTheSameInAllDirectionsOfOneSide) {
  const Diffuse bsdf{{0.25f, 0.5f, 1}};
  for (const float side : {1.0f, -1.0f}) {
    const Vec3 wo(0.6f, 0, side * 0.8f);
    EXPECT_NEAR(bsdf.evaluate(wo, {0, 0.8f, side * 0.6f}).f.y, 0.5 * 0.6 / pi_double, 1e-7);
    EXPECT_TRUE(is_black(bsdf.evaluate(wo, {0, 0.8f, side * -0.6f}).f));
  }
}

// The order of the list is the number that materials store; names tell the BSDFs apart.
TEST(Bsdfs, AreNumberedByTheirPlaceInTheList) {
  std::set<std::string> names;
  int index = 0;
  for_each_type(Bsdfs{}, [&](auto type) {
    using Bsdf = typename decltype(type)::type;
    EXPECT_EQ(static_cast<int>(kind_of<Bsdf>), index++);
    EXPECT_LE(Bsdf::parameter_count, parameters_max);
    EXPECT_TRUE(names.insert(Bsdf::name).second);
    visit(kind_of<Bsdf>, MaterialDescription(), [](const auto& bsdf) {
      EXPECT_TRUE((std::is_same_v<std::remove_cvref_t<decltype(bsdf)>, Bsdf>));
    });
  });
}

}  // namespace
}  // namespace pt
