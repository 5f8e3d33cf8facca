// Every BSDF of the list: light is neither made nor, where nothing absorbs it, lost; and it goes
// both ways alike.
#include <gtest/gtest.h>

#include "material/bsdf_integral.h"

namespace pt {
namespace {

double largest(const Vec3d& v) { return std::max({v.x, v.y, v.z}); }

// The albedo is the same by quadrature of evaluate() and by the mean weight of sample(). A lossless
// surface in a uniformly bright world is as bright: it cannot be seen (the white furnace).
TEST(BsdfEnergy, IsAtMostWhatArrives) {
  for_each_bsdf([](const BsdfCase& one, const auto& bsdf, const Vec3& wo) {
    const BsdfIntegral integral(bsdf, wo);
    const Vec3d albedo = integral.albedo(), sampled = integral.sampled_albedo();
    constexpr double tolerance = 1.5e-3;
    EXPECT_LE(largest(albedo), one.albedo_max + tolerance);
    EXPECT_LE(largest(glm::abs(albedo - sampled)), tolerance + integral.sampled_error());
    if (!one.is_lossless) return;
    EXPECT_LE(largest(glm::abs(albedo - 1.0)), tolerance) << "white furnace";
    EXPECT_LE(largest(glm::abs(sampled - 1.0)), tolerance) << "white furnace, sampled";
  });
}

// f(o, i) eta^2 = f(i, o), where eta is the index at i over that at o (Veach 1997, section 5.2).
TEST(BsdfEnergy, IsReciprocal) {
  TestRandom random;
  for_each_bsdf([&](const BsdfCase& one, const auto& bsdf, const Vec3& wo) {
    if (!one.is_reciprocal || bsdf.is_delta()) return;
    const double eta = passing_eta(bsdf, wo).value_or(1.0);
    for (int i = 0; i < 2000; ++i) {
      const Vec3 wi(random.direction());
      const double scale = same_side(wo, wi) ? 1 : eta * eta;
      const Vec3d there =
          scale * Vec3d(bsdf.evaluate(wo, wi).f) / std::abs(static_cast<double>(wi.z));
      const Vec3d back = Vec3d(bsdf.evaluate(wi, wo).f) / std::abs(static_cast<double>(wo.z));
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(there[c], back[c], 2e-5 * (there[c] + back[c]) + 1e-30);
    }
  });
}

// One that only reflects cannot tell the sides of a surface apart.
TEST(BsdfEnergy, IsTheSameOnBothSides) {
  TestRandom random;
  const Vec3 flip(1, 1, -1);
  for_each_bsdf([&](const BsdfCase&, const auto& bsdf, const Vec3& wo) {
    if (passing_eta(bsdf, {0, 0, 1}) || passing_eta(bsdf, {0, 0, -1})) return;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 wi(random.direction());
      const BsdfValue here = bsdf.evaluate(wo, wi), there = bsdf.evaluate(flip * wo, flip * wi);
      ASSERT_NEAR(here.pdf, there.pdf, 1e-6 * here.pdf);
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(here.f[c], there.f[c], 1e-6 * here.f[c]);
    }
  });
}

}  // namespace
}  // namespace pt
