// Every material of the list against the contract of bsdf.h. A new kind needs one `case` below, and
// does not compile without it.
#include <gtest/gtest.h>

#include "common/material/material.h"
#include "statistics.h"

namespace pt {
namespace {

using Vec3d = glm::dvec3;

struct Sample {
  const char* name;
  Material material;
  bool is_reciprocal = true;
};

#pragma GCC diagnostic push
#pragma GCC diagnostic error "-Wswitch"
/// White ones and coloured ones, at the ends of each parameter's range and between; none for a
/// number that is no kind.
std::vector<Sample> parameter_sets(MaterialKind kind) {
  const Color white(1.0f), color(0.25f, 0.5f, 0.75f);
  switch (kind) {
    case MaterialKind::diffuse:
      return {{"diffuse, white", make_diffuse(white)}, {"diffuse", make_diffuse(color)}};
    case MaterialKind::metal:  // not reciprocal when fuzzy: its lobe is absorbed below the surface
      return {{"mirror, white", make_metal(white, 0)},
              {"mirror", make_metal(color, 0)},
              {"metal, fuzz 0.05", make_metal(white, 0.05f), false},
              {"metal, fuzz 0.3", make_metal(color, 0.3f), false},
              {"metal, fuzz 1", make_metal(white, 1), false}};
    case MaterialKind::dielectric:
      return {{"glass", make_dielectric(white, 1.5f)},
              {"tinted diamond", make_dielectric(color, 2.4f)},
              {"air in glass", make_dielectric(white, 1 / 1.5f)},
              {"nothing", make_dielectric(white, 1)}};
  }
  return {};
}
#pragma GCC diagnostic pop

std::vector<Sample> all_materials() {
  std::vector<Sample> all;
  for (std::uint32_t kind = 0;; ++kind) {
    const std::vector<Sample> sets = parameter_sets(static_cast<MaterialKind>(kind));
    if (sets.empty()) return all;
    all.insert(all.end(), sets.begin(), sets.end());
  }
}

/// Calls test(name, is_reciprocal, bsdf, wo, n) for every material and for directions from the
/// normal to grazing, on both sides of the surface.
template <class Test>
void for_each_bsdf(const Test& test) {
  const Vec3d normals[] = {{0, 0, 1}, {0.48, -0.6, 0.64}};
  for (const Sample& sample : all_materials()) {
    SCOPED_TRACE(sample.name);
    int turn = 0;
    for (const double cosine : {1.0, 0.7, 0.2, 0.02, -0.02, -0.4, -1.0}) {
      SCOPED_TRACE(testing::Message() << "cos(wo) = " << cosine);
      const Vec3d n = normals[turn++ % 2];
      const Vec3d t = glm::normalize(glm::cross(Vec3d(0.1, 1, 0.2), n));
      const Vec3 wo(cosine * n + std::sqrt(1 - cosine * cosine) * t);
      visit(sample.material, [&](const auto& bsdf) { test(sample, bsdf, wo, Vec3(n)); });
    }
  }
}

Vec4 random_numbers(TestRandom& random) {
  return {random.unit(), random.unit(), random.unit(), random.unit()};
}

// A grid around the mirror direction, finer near it, with an additional cell for what is absorbed.
constexpr int rings = 24, sectors = 24, absorbed = rings * sectors;

struct Grid {
  Grid(const Vec3& wo, const Vec3& n) : pole(reflect(wo, n)) {
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
  for_each_bsdf([&](const Sample& sample, const auto& bsdf, const Vec3& wo, const Vec3& n) {
    if (bsdf.is_delta()) return;
    const Grid grid(wo, n);
    constexpr int count = 100'000;
    std::vector<double> counts(rings * sectors + 1);
    for (int i = 0; i < count; ++i) {
      const BsdfSample s = bsdf.sample(wo, n, random_numbers(random));
      ++counts[is_black(s.weight) ? absorbed : grid.cell(s.wi)];
    }
    std::vector<double> expected =
        grid.integrate([&](const Vec3& wi) { return bsdf.pdf(wo, wi, n); });
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
  for_each_bsdf([&](const Sample&, const auto& bsdf, const Vec3& wo, const Vec3& n) {
    int without_density = 0;
    constexpr int count = 20'000;
    for (int i = 0; i < count; ++i) {
      const BsdfSample s = bsdf.sample(wo, n, random_numbers(random));
      if (is_black(s.weight)) continue;
      ASSERT_NEAR(glm::length(Vec3d(s.wi)), 1, 1e-6);
      const float pdf = bsdf.pdf(wo, s.wi, n);
      const Color f = bsdf.evaluate(wo, s.wi, n);
      if (bsdf.is_delta()) {
        ASSERT_EQ(pdf, 0.0f);
        ASSERT_TRUE(is_black(f));
      } else if (pdf > 0) {
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(s.weight[c], f[c] / pdf, 1e-5);
      } else {
        ++without_density;  // by rounding at the edge of the lobe
      }
    }
    EXPECT_LE(without_density, count / 1000);
  });
}

TEST(Bsdf, IsReciprocal) {
  TestRandom random;
  for_each_bsdf([&](const Sample& sample, const auto& bsdf, const Vec3& wo, const Vec3& n) {
    if (!sample.is_reciprocal) return;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 wi(random.direction());
      const Color there = bsdf.evaluate(wo, wi, n) / std::abs(dot(wi, n));
      const Color back = bsdf.evaluate(wi, wo, n) / std::abs(dot(wo, n));
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(there[c], back[c], 1e-5 * (there[c] + back[c]));
    }
  });
}

/// Radiance over the square of the index of refraction is what does not grow on its way.
float energy_ratio(const Material& material, const Vec3& wo, const Vec3& wi, const Vec3& n) {
  if (material.kind != MaterialKind::dielectric || glm::dot(wo, n) * glm::dot(wi, n) >= 0) return 1;
  const float eta2 = material.parameter * material.parameter;
  return glm::dot(wo, n) > 0 ? eta2 : 1 / eta2;
}

TEST(Bsdf, NeverCreatesEnergy) {
  TestRandom random;
  for_each_bsdf([&](const Sample& sample, const auto& bsdf, const Vec3& wo, const Vec3& n) {
    for (int i = 0; i < 5000; ++i) {
      const BsdfSample s = bsdf.sample(wo, n, random_numbers(random));
      const Color w = s.weight * energy_ratio(sample.material, wo, s.wi, n);
      ASSERT_TRUE(w.x >= 0 && w.y >= 0 && w.z >= 0);
      ASSERT_LE(std::max({w.x, w.y, w.z}), 1 + 1e-6) << "no kind so far weighs above 1";
    }
    if (bsdf.is_delta()) return;
    double albedo = 0;
    for (const double part : Grid(wo, n).integrate([&](const Vec3& wi) {
           const Color f = bsdf.evaluate(wo, wi, n);
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
    const Vec3 n(0, 0, side), wo(0.6f, 0, 0.8f);
    EXPECT_NEAR(bsdf.evaluate(wo, {0, 0.8f, 0.6f}, n).y, 0.5 * 0.6 / pi_double, 1e-7);
    EXPECT_TRUE(is_black(bsdf.evaluate(wo, {0, 0.8f, -0.6f}, n)));
  }
}

}  // namespace
}  // namespace pt
