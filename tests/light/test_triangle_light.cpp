// Triangles that emit, and lights without extent: samples, densities and the irradiance that
// follows, against analytic values and numerical integration.
#include <gtest/gtest.h>

#include <array>

#include "common/light/lights.h"
#include "common/transport/sample_light.h"
#include "statistics.h"

namespace pt {
namespace {

using Vec3d = glm::dvec3;
using TriangleCorners = std::array<Vec3, 3>;

TriangleLightSample sample(const TriangleCorners& t, const Vec3& from, TestRandom& random) {
  const float u0 = random.unit();
  return sample_triangle(t[0], t[1] - t[0], t[2] - t[0], {1e-6f, light_rounding}, from, u0,
                         random.unit());
}

/// A triangle whose front faces the origin, neither thin nor too obliquely.
TriangleCorners facing_triangle(TestRandom& random) {
  for (;;) {
    const Vec3d center = random.log_uniform(0.5, 10) * random.direction();
    const double size = random.log_uniform(0.1, 3);
    std::array<Vec3d, 3> v;
    for (Vec3d& p : v) p = center + size * random.direction();
    const Vec3d normal = glm::cross(v[1] - v[0], v[2] - v[0]);
    if (glm::length(normal) > 0.5 * size * size &&
        -glm::dot(normal, v[0]) > 0.1 * glm::length(normal))
      return {Vec3(v[0]), Vec3(v[1]), Vec3(v[2])};
  }
}

/// Van Oosterom and Strackee 1983, from the origin.
double solid_angle(const TriangleCorners& t) {
  const Vec3d a = glm::normalize(Vec3d(t[0])), b = glm::normalize(Vec3d(t[1])),
              c = glm::normalize(Vec3d(t[2]));
  return 2 * std::atan2(std::abs(glm::dot(a, glm::cross(b, c))),
                        1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
}

/// Lambert's formula: a receiver at the origin with normal `n`, the triangle above its horizon.
double triangle_irradiance(const TriangleCorners& t, const Vec3d& n) {
  Vec3d sum(0);
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d v = glm::normalize(Vec3d(t[i])), w = glm::normalize(Vec3d(t[(i + 1) % 3]));
    sum += std::acos(glm::dot(v, w)) * glm::normalize(glm::cross(v, w));
  }
  return std::abs(0.5 * glm::dot(sum, n));
}

TEST(TriangleLight, PointsAreUniform) {
  TestRandom random;
  constexpr int n = 16, samples = 500'000;
  std::vector<double> counts(n * n);
  for (int i = 0; i < samples; ++i) {
    const float u0 = random.unit();
    const TrianglePoint p = sample_triangle_point(u0, random.unit());
    ASSERT_TRUE(p.b1 >= 0 && p.b2 >= 0 && p.b1 + p.b2 <= 1) << p.b1 << " " << p.b2;
    // b1 has distribution 1 - (1 - b1)^2; given it, b2 is uniform in [0, 1 - b1].
    const double rest = 1 - double{p.b1};
    ++counts[n * cell_of(1 - rest * rest, n) + cell_of(p.b2 / rest, n)];
  }
  expect_uniform(counts, samples, "triangle");
}

TEST(TriangleLight, SamplesLieOnTheTriangleAndDensitiesAgree) {
  TestRandom random(2);
  for (int k = 0; k < 50; ++k) {
    const TriangleCorners t = facing_triangle(random);
    const Vec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
    MeanEstimate angle;
    for (int i = 0; i < 5000; ++i) {
      const auto [s, point] = sample(t, Vec3(0.0f), random);
      ASSERT_NEAR(glm::length(Vec3d(s.wi)), 1, 1e-6);
      ASSERT_TRUE(std::isfinite(s.pdf) && s.pdf > 0) << s.pdf;
      const Vec3d p = Vec3d(t[0]) + double{point.b1} * Vec3d(t[1] - t[0]) +
                      double{point.b2} * Vec3d(t[2] - t[0]);
      const double distance = glm::length(p);
      ASSERT_LT(glm::length(p - distance * Vec3d(s.wi)), 1e-5 * (1 + distance));
      // In front of the triangle by the error that was given.
      const double error = 1e-6 + light_rounding * distance;
      const Vec3d unit = glm::normalize(Vec3d(normal));
      ASSERT_NEAR(glm::dot(Vec3d(s.end) - p, unit), error, 1e-6 * (1 + distance));
      ASSERT_LT(glm::length(Vec3d(s.end) - p - error * unit), 2e-6 * (1 + distance));
      const auto d = static_cast<float>(distance);
      const TriangleSampler sampler(t[0], t[1] - t[0], t[2] - t[0]);
      ASSERT_NEAR(sampler.pdf(s.wi, d), s.pdf, 1e-4 * s.pdf);
      angle.add(1 / s.pdf);
    }
    EXPECT_NEAR(angle.mean(), solid_angle(t), 5 * angle.sigma() + 1e-5 * angle.mean());
  }
}

TEST(TriangleLight, IrradianceIsLamberts) {
  TestRandom random(3);
  int tested = 0;
  for (int k = 0; k < 100; ++k) {
    const TriangleCorners t = facing_triangle(random);
    const Vec3d n = random.direction();
    if (!std::all_of(t.begin(), t.end(), [&](const Vec3& v) { return glm::dot(Vec3d(v), n) > 0; }))
      continue;
    MeanEstimate estimate;
    for (int i = 0; i < 20'000; ++i) {
      const LightSample s = sample(t, Vec3(0.0f), random).light;
      estimate.add(std::max(0.0, glm::dot(Vec3d(s.wi), n)) / s.pdf);
    }
    EXPECT_NEAR(estimate.mean(), triangle_irradiance(t, n),
                5 * estimate.sigma() + 1e-5 * estimate.mean());
    ++tested;
  }
  EXPECT_GE(tested, 20);
}

// Far from the scene's origin, as in a large scene: positions are exact, their difference is small.
TEST(TriangleLight, SamplesArePreciseFarFromTheOrigin) {
  TestRandom random(4);
  const Vec3 far(4096, -2048, 8192);
  for (int k = 0; k < 20; ++k) {
    TriangleCorners t = facing_triangle(random);
    const double angle = solid_angle(t);
    for (Vec3& v : t) v = far + v;  // rounds to 2^-10
    MeanEstimate estimate;
    for (int i = 0; i < 2000; ++i) estimate.add(1 / sample(t, far, random).light.pdf);
    EXPECT_NEAR(estimate.mean(), angle, 5 * estimate.sigma() + 0.02 * angle);
  }
}

TEST(TriangleLight, IsDarkFromBehindFromItsPlaneAndWithoutArea) {
  const Vec3 a(-1, 2, -1), b(1, 2, -1), c(-1, 2, 1);  // cross(b - a, c - a) points down
  EXPECT_GT(sample_triangle(a, b - a, c - a, {}, {0, 0, 0}, 0.5f, 0.5f).light.pdf, 0.0f);
  EXPECT_EQ(sample_triangle(a, b - a, c - a, {}, {0, 3, 0}, 0.3f, 0.6f).light.pdf, 0.0f);
  EXPECT_EQ(sample_triangle(a, b - a, c - a, {}, {5, 2, 0}, 0.3f, 0.6f).light.pdf, 0.0f);
  EXPECT_EQ(sample_triangle(a, b - a, b - a, {}, {0, 0, 0}, 0.3f, 0.6f).light.pdf, 0.0f)
      << "no area";
  const TrianglePoint p = sample_triangle_point(0.25f, 0.25f);
  const Vec3 itself = a + p.b1 * (b - a) + p.b2 * (c - a);
  EXPECT_EQ(sample_triangle(a, b - a, c - a, {}, itself, 0.25f, 0.25f).light.pdf, 0.0f)
      << "the point itself";
}

IncidentLight sample_delta_light(const DeltaLight& light, const Vec3& from) {
  return sample_other_light(make_light(light, 1), from, 0.5f, 0.5f).incident;
}

DeltaLight spot(SpotFalloff falloff, double inner_degrees, double outer_degrees) {
  DeltaLight light;
  light.kind = LightKind::spot;
  light.intensity = Color(2.0f);
  light.cos_inner = static_cast<float>(std::cos(inner_degrees * pi_double / 180));
  light.cos_outer = static_cast<float>(std::cos(outer_degrees * pi_double / 180));
  light.falloff = falloff;
  return light;
}

TEST(DeltaLight, APointFollowsTheInverseSquare) {
  DeltaLight light;
  light.position = {1, 2, 3};
  light.intensity = {8, 4, 2};
  const IncidentLight s = sample_delta_light(light, {1, 2, 1});
  EXPECT_EQ(s.wi, Vec3(0, 0, 1));
  EXPECT_NEAR(s.end.z, 2, 1e-5) << "short of it by rounding errors, for it may lie on a surface";
  EXPECT_LT(s.end.z, 2 - 1e-6f);
  EXPECT_EQ(s.radiance, Color(2, 1, 0.5f));
  EXPECT_EQ(sample_delta_light(light, light.position).radiance, Color(0.0f));
}

TEST(DeltaLight, ADirectionalOneIsTheSameEverywhere) {
  DeltaLight light;
  light.kind = LightKind::directional;
  light.direction = {0.6f, -0.8f, 0};
  light.intensity = {3, 2, 1};
  for (const Vec3& from : {Vec3(0.0f), Vec3(1e6f, -5, 2)}) {
    const IncidentLight s = sample_delta_light(light, from);
    EXPECT_EQ(s.wi, Vec3(-0.6f, 0.8f, 0));
    EXPECT_EQ(s.end, beyond_scene * s.wi);
    EXPECT_EQ(s.radiance, light.intensity);
  }
}

// Golden values: Mitsuba 3.9's spot emitter, beam_width 20, cutoff_angle 30, intensity 2, asked by
// sample_direction from 3 units away, at these angles to its axis.
TEST(DeltaLight, ASpotWithLinearAngleIsMitsubas) {
  const DeltaLight light = spot(SpotFalloff::linear_angle, 20, 30);
  const std::pair<double, double> golden[] = {
      {0, 0.222222238779},  {19, 0.222222238779},   {21, 0.199999898672},    {23, 0.155555769801},
      {25, 0.111111223698}, {28, 0.04444456845522}, {29.5, 0.0111111989245}, {31, 0}};
  for (const auto& [degrees, irradiance] : golden) {
    const double a = degrees * pi_double / 180;
    const IncidentLight s =
        sample_delta_light(light, Vec3(Vec3d(3 * std::sin(a), 0, -3 * std::cos(a))));
    EXPECT_NEAR(s.radiance.x, irradiance, 2e-6) << degrees;
    EXPECT_NEAR(glm::length(s.end), 3, 2e-5);
  }
}

TEST(DeltaLight, EverySpotFallsFromOneToZero) {
  for (const SpotFalloff falloff :
       {SpotFalloff::smooth, SpotFalloff::linear_angle, SpotFalloff::square_cosine}) {
    const DeltaLight light = spot(falloff, 15, 40);
    float last = 1;
    for (int i = 0; i <= 90; ++i) {
      const double degrees = i;
      const auto cosine = static_cast<float>(std::cos(degrees * pi_double / 180));
      const float share = spot_share(light, cosine);
      EXPECT_EQ(share == 1, degrees <= 15) << degrees;
      EXPECT_EQ(share == 0, degrees >= 40) << degrees;
      EXPECT_LE(share, last);
      EXPECT_LE(last - share, 0.1f) << "a step at " << degrees;
      last = share;
    }
    // Without a border between them there is a step, and no division by zero.
    const DeltaLight hard = spot(falloff, 30, 30);
    EXPECT_EQ(spot_share(hard, 0.87f), 1.0f);
    EXPECT_EQ(spot_share(hard, 0.86f), 0.0f);
  }
}

/// For a white light, whose weight is the power's luminance over pi.
double power_of(const DeltaLight& light, float scene_radius) {
  return pi_double * double{make_light(light, scene_radius).weight};
}

// All that a light sends through a sphere around it.
TEST(DeltaLight, PowerIsTheIntegralOfTheIntensity) {
  DeltaLight point;
  point.intensity = Color(2.0f);
  for (const DeltaLight& light : {point, spot(SpotFalloff::smooth, 20, 50)}) {
    TestRandom random(5);
    MeanEstimate estimate;
    for (int i = 0; i < 200'000; ++i) {
      const Vec3 from(7.0 * random.direction());
      estimate.add(sample_delta_light(light, from).radiance.x * 4 * pi_double * 49);
    }
    EXPECT_NEAR(estimate.mean(), power_of(light, 1), 5 * estimate.sigma() + 1e-5 * estimate.mean());
  }
  DeltaLight sun;
  sun.kind = LightKind::directional;
  EXPECT_NEAR(power_of(sun, 3), 9 * pi_double, 1e-5);
}

}  // namespace
}  // namespace pt
