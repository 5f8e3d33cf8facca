// Mirrors and glass against the laws of reflection, of Snell and of Fresnel in double precision.
#include <gtest/gtest.h>

#include "common/material/material.h"
#include "common/math/transform.h"
#include "statistics.h"

namespace pt {
namespace {

using Vec3d = glm::dvec3;

Vec3 random_numbers(TestRandom& random) { return {random.unit(), random.unit(), random.unit()}; }

/// As a surface with this normal has it: in a frame around it, and back.
template <class Bsdf>
BsdfSample sample_around(const Vec3d& n, const Bsdf& bsdf, const Vec3d& wo, const Vec3& u) {
  const Frame frame = make_frame(Vec3(n));
  BsdfSample s = bsdf.sample(frame.to_local(Vec3(wo)), u);
  s.wi = frame.to_world(s.wi);
  return s;
}

TEST(Mirror, AngleOfReflectionIsAngleOfIncidence) {
  TestRandom random;
  for (int i = 0; i < 10'000; ++i) {
    const Vec3d n = random.direction(), wo = random.direction();
    const BsdfSample s = sample_around(n, Metal{Color(0.7f), 0}, wo, random_numbers(random));
    ASSERT_LE(glm::length(Vec3d(s.wi) - (2 * glm::dot(wo, n) * n - wo)), 1e-6);
  }
}

/// Fresnel's equations as in Born and Wolf, section 1.5.2, from the two angles.
double fresnel(double cos_i, double eta) {
  const double theta_i = std::acos(cos_i), sin_t = std::sin(theta_i) / eta;
  if (sin_t >= 1) return 1;
  const double theta_t = std::asin(sin_t);
  if (theta_i < 1e-4) return (eta - 1) * (eta - 1) / ((eta + 1) * (eta + 1));
  const double s = std::sin(theta_i - theta_t) / std::sin(theta_i + theta_t);
  const double p = std::tan(theta_i - theta_t) / std::tan(theta_i + theta_t);
  return 0.5 * (s * s + p * p);
}

const float etas[] = {1 / 2.4f, 1 / 1.5f, 1 / 1.33f, 0.999f, 1, 1.001f, 1.33f, 1.5f, 2.4f};

TEST(Dielectric, FresnelAgreesWithItsEquations) {
  for (const float eta : etas) {
    for (int i = 0; i <= 100'000; ++i) {
      const float cos_i = static_cast<float>(i) / 100'000;
      if (cos_i < 0.02f && std::abs(eta - 1) < 0.01f) continue;  // 1 - (1 - cos^2) cancels
      // Near the critical angle the slope is infinite: allow for a rounded squared cosine.
      const double cos2 = double{cos_i} * cos_i;
      const double lo = fresnel(std::sqrt(std::min(cos2 + 2.5e-7, 1.0)), eta);
      const double hi = fresnel(std::sqrt(std::max(cos2 - 2.5e-7, 0.0)), eta);
      const float f = fresnel_dielectric(cos_i, eta);
      ASSERT_GE(f, std::min(lo, hi) - 1e-5) << cos_i << ", eta " << eta;
      ASSERT_LE(f, std::max(lo, hi) + 1e-5) << cos_i << ", eta " << eta;
    }
    EXPECT_NEAR(fresnel_dielectric(1, eta), std::pow((eta - 1) / (eta + 1), 2), 1e-6);
  }
}

TEST(Dielectric, ReflectsWithFresnelsProbabilityElseRefractsBySnell) {
  TestRandom random;
  int reflected = 0, refracted = 0;
  for (int i = 0; i < 300'000; ++i) {
    const float eta = etas[random.below(9)];
    const Vec3d n = random.direction(), wo = random.direction();
    const double cos_o = glm::dot(wo, n), relative = cos_o > 0 ? eta : 1.0 / eta;
    const double f = fresnel(std::abs(cos_o), relative);
    const Vec3 u = random_numbers(random);
    if (std::abs(u.x - f) < 1e-4) continue;
    const BsdfSample s = sample_around(n, Dielectric{Color(0.5f), eta}, wo, u);
    const Vec3d wi(s.wi);
    // Radiance over the square of the index of refraction is what passes.
    const double passes = u.x < f ? 1 : 1 / (relative * relative);
    ASSERT_NEAR(s.weight.x, 0.5 * passes, 1e-6 * passes);
    // Roulette sees a path as it would be outside.
    ASSERT_NEAR(s.eta_scale, glm::dot(wi, n) < 0 ? double{eta} * eta : 1, 1e-5);
    const Vec3d tangent_o = wo - cos_o * n, tangent_i = wi - glm::dot(wi, n) * n;
    if (u.x < f) {
      ++reflected;
      ASSERT_LE(glm::length(wi - (2 * cos_o * n - wo)), 1e-6);
    } else {
      ++refracted;
      ASSERT_LE(glm::dot(wi, n) * cos_o, 1e-6) << "stays on its side";
      ASSERT_LE(glm::length(relative * tangent_i + tangent_o), 3e-6 * std::max(1.0, relative));
    }
  }
  EXPECT_GT(reflected, 30'000);
  EXPECT_GT(refracted, 100'000);
}

}  // namespace
}  // namespace pt
