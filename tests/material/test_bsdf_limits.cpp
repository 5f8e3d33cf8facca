// Every BSDF of the list at the ends of what it may be asked: along the surface, in opposite and in
// equal directions, with the first and the last random numbers, and with no roughness.
#include <gtest/gtest.h>

#include "material/each_bsdf.h"

namespace pt {
namespace {

bool is_fine(const Color& c) {
  return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z) && c.x >= 0 && c.y >= 0 &&
         c.z >= 0;
}

std::vector<Vec3> hard_directions() {
  std::vector<Vec3> all;
  for (const double cosine : {1e-7, 1e-5, 1e-3, 0.5, 0.9999999, 1.0}) {
    for (const double side : {1.0, -1.0}) {
      const double sine = std::sqrt(1 - cosine * cosine);
      all.emplace_back(sine, 0, side * cosine);
      all.emplace_back(-sine, 0, side * cosine);
      all.emplace_back(0.6 * sine, -0.8 * sine, side * cosine);
      all.emplace_back(-0.6 * sine, 0.8 * sine, side * cosine);
    }
  }
  return all;
}

void expect_fine(const BsdfSample& s) {
  EXPECT_TRUE(is_fine(s.weight)) << s.weight.x << " " << s.weight.y << " " << s.weight.z;
  if (is_black(s.weight)) return;
  EXPECT_NEAR(glm::length(Vec3d(s.wi)), 1, 1e-5);
  EXPECT_TRUE(std::isfinite(s.pdf) && s.pdf >= 0) << s.pdf;
  EXPECT_TRUE(std::isfinite(s.eta) && s.eta > 0);
  EXPECT_TRUE(std::isfinite(s.eta_scale) && s.eta_scale > 0);
}

template <class Bsdf>
void expect_fine_from(const Bsdf& bsdf, const Vec3& wo, TestRandom& random) {
  for (const Vec3& wi : hard_directions()) {
    const BsdfValue value = bsdf.evaluate(wo, wi);
    EXPECT_TRUE(is_fine(value.f)) << value.f.x << " at cos(wi) = " << wi.z;
    EXPECT_TRUE(std::isfinite(value.pdf) && value.pdf >= 0) << value.pdf;
  }
  const float ends[] = {0.0f, 0x1p-24f, 0.5f, one_minus_ulp};
  for (const float x : ends) {
    for (const float y : ends) {
      for (const float z : ends) expect_fine(bsdf.sample(wo, {x, y, z}));
    }
  }
  for (int i = 0; i < 200; ++i) expect_fine(bsdf.sample(wo, random_numbers(random)));
}

TEST(BsdfLimits, ValuesAreFiniteAndNotNegative) {
  TestRandom random;
  for (const BsdfCase& one : all_bsdf_cases()) {
    SCOPED_TRACE(one.name);
    for (const Vec3& wo : hard_directions()) {
      SCOPED_TRACE(testing::Message() << "wo = " << wo.x << " " << wo.y << " " << wo.z);
      visit(one.material.kind, one.material,
            [&](const auto& bsdf) { expect_fine_from(bsdf, wo, random); });
      if (testing::Test::HasFailure()) return;
    }
  }
}

}  // namespace
}  // namespace pt
