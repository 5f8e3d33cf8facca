// Light sampling: the densities that it claims, the directions that it chooses, and the irradiance
// that follows, against analytic form factors.
#include <gtest/gtest.h>

#include <array>

#include "common/geometry/primitives.h"
#include "common/light/area_light.h"
#include "common/light/sky/environment.h"
#include "statistics.h"

namespace pt {
namespace {

using Vec3d = glm::dvec3;

/// A parallelogram whose front faces the origin, not too obliquely.
Quad facing_quad(TestRandom& random) {
  for (;;) {
    const Vec3d a = random.log_uniform(0.1, 3) * random.direction();
    const Vec3d b = random.log_uniform(0.1, 3) * random.direction();
    const Vec3d center = random.log_uniform(0.5, 10) * random.direction();
    const Quad quad = make_quad(Vec3(center - 0.5 * (a + b)), Vec3(a), Vec3(b));
    const bool skewed = quad.area < 0.2 * glm::length(a) * glm::length(b);
    if (!skewed && -glm::dot(Vec3d(quad.normal), Vec3d(quad.corner)) > 0.1) return quad;
  }
}

Sphere distant_sphere(TestRandom& random, double distance_over_radius) {
  const double radius = random.log_uniform(1e-3, 1e3);
  const auto r = static_cast<float>(radius);
  return {Vec3(radius * distance_over_radius * random.direction()), r * r};
}

std::array<Vec3d, 4> corners(const Quad& q) {
  const Vec3d c(q.corner), a(q.edge_a), b(q.edge_b);
  return {c, c + a, c + a + b, c + b};
}

/// Lambert's formula for a polygon of radiance 1 above the horizon of a receiver at the origin.
double polygon_irradiance(const Quad& quad, const Vec3d& n) {
  const auto p = corners(quad);
  Vec3d sum(0);
  for (int i = 0; i < 4; ++i) {
    const Vec3d v = glm::normalize(p[i]), w = glm::normalize(p[(i + 1) % 4]);
    sum += std::acos(glm::dot(v, w)) * glm::normalize(glm::cross(v, w));
  }
  return std::abs(0.5 * glm::dot(sum, n));
}

/// Van Oosterom and Strackee 1983, for the two triangles of a quad.
double solid_angle(const Quad& quad) {
  const auto p = corners(quad);
  double sum = 0;
  for (const auto& [i, j] : {std::pair{1, 2}, {2, 3}}) {
    const Vec3d a = glm::normalize(p[0]), b = glm::normalize(p[i]), c = glm::normalize(p[j]);
    sum += 2 * std::atan2(std::abs(glm::dot(a, glm::cross(b, c))),
                          1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
  }
  return sum;
}

/// What every sample must be: a unit vector, a density that agrees with primitive_pdf where a ray
/// meets the light, and a shadow ray that ends there and that the light itself does not stop.
void expect_consistent(const Primitives& light, const LightSample& s, const Vec3& from) {
  ASSERT_NEAR(glm::length(Vec3d(s.wi)), 1, 1e-6);
  ASSERT_TRUE(std::isfinite(s.pdf) && s.pdf > 0) << s.pdf;
  const float length = glm::length(s.end);
  ASSERT_TRUE(std::isfinite(length) && length > 0) << length;
  const float itself = primitive_distance(light, 0, {from, normalize(s.end)});
  ASSERT_TRUE(itself <= 0 || itself > length) << "the light shadows itself: " << itself;
  const float t = primitive_distance(light, 0, {from, s.wi});
  if (t <= 0) return;  // past the rim, by rounding
  const Bounds box =
      light.sphere_count > 0 ? sphere_bounds(light.spheres[0]) : quad_bounds(light.quads[0]);
  const float size = glm::length(box.max - box.min);
  // Off the light by its rounding errors; along a grazing ray a sphere's points move further.
  ASSERT_LT(glm::length(s.end - t * s.wi), (light.sphere_count > 0 ? 1e-2 : 1e-5) * (t + size));
  ASSERT_LT(std::abs(length - t), (light.sphere_count > 0 ? 1e-2 : 1e-5) * (t + size));
  const float pdf = primitive_pdf(light, 0, from, s.wi, t);
  ASSERT_NEAR(pdf, s.pdf, 1e-4 * s.pdf);
}

TEST(QuadLight, SamplesAreUniformOverTheArea) {
  TestRandom random;
  for (int k = 0; k < 20; ++k) {
    const Quad quad = facing_quad(random);
    const Primitives light{nullptr, &quad, 0, 1};
    constexpr int n = 12, samples = 50'000;
    std::vector<double> counts(n * n);
    MeanEstimate angle;
    for (int i = 0; i < samples; ++i) {
      const LightSample s = sample_primitive(light, 0, Vec3(0.0f), random.unit(), random.unit());
      expect_consistent(light, s, Vec3(0.0f));
      angle.add(1 / s.pdf);
      const Vec3d normal(quad.normal);
      const double t = glm::dot(normal, Vec3d(quad.corner)) / glm::dot(normal, Vec3d(s.wi));
      const Vec3d p = t * Vec3d(s.wi) - Vec3d(quad.corner);
      ++counts[n * cell_of(glm::dot(p, Vec3d(quad.dual_a)), n) +
               cell_of(glm::dot(p, Vec3d(quad.dual_b)), n)];
    }
    expect_uniform(counts, samples, "quad");
    EXPECT_NEAR(angle.mean(), solid_angle(quad), 5 * angle.sigma() + 1e-5 * angle.mean());
  }
}

TEST(QuadLight, IsDarkFromBehindAndFromItsPlane) {
  const Quad quad = make_quad({-1, 2, -1}, {2, 0, 0}, {0, 0, 2});  // faces down
  EXPECT_GT(sample_quad(quad, {0, 0, 0}, 0.5f, 0.5f).pdf, 0.0f);
  EXPECT_EQ(sample_quad(quad, {0, 3, 0}, 0.3f, 0.6f).pdf, 0.0f);
  EXPECT_EQ(sample_quad(quad, {5, 2, 0}, 0.3f, 0.6f).pdf, 0.0f);
  EXPECT_EQ(sample_quad(quad, {0, 2, 0}, 0.5f, 0.5f).pdf, 0.0f) << "the sampled point itself";
  EXPECT_EQ(quad_solid_angle_pdf(quad, {0, -1, 0}, 1), 0.0f);
  EXPECT_NEAR(quad_solid_angle_pdf(quad, {0, 1, 0}, 2), 1, 1e-6);
}

TEST(SphereLight, SamplesAreUniformOverTheConeThatIsSeen) {
  TestRandom random(2);
  for (const double ratio : {1.001, 1.1, 2.0, 10.0, 100.0}) {
    for (int k = 0; k < 4; ++k) {
      const Sphere sphere = distant_sphere(random, ratio);
      const Primitives light{&sphere, nullptr, 1, 0};
      const Vec3d axis = glm::normalize(Vec3d(sphere.center));
      const Vec3d x = glm::normalize(glm::cross(axis, random.direction()));
      const Vec3d y = glm::cross(axis, x);
      const double sin2_max =
          sphere.radius_squared / glm::dot(Vec3d(sphere.center), Vec3d(sphere.center));
      constexpr int n = 12, samples = 50'000;
      std::vector<double> counts(n * n);
      for (int i = 0; i < samples; ++i) {
        const LightSample s = sample_primitive(light, 0, Vec3(0.0f), random.unit(), random.unit());
        expect_consistent(light, s, Vec3(0.0f));
        const double px = glm::dot(Vec3d(s.wi), x), py = glm::dot(Vec3d(s.wi), y);
        // 1 - cos, by way of the sine, over its largest value.
        const auto versine = [](double sin2) { return sin2 / (1 + std::sqrt(1 - sin2)); };
        const double height = versine(std::min(px * px + py * py, 1.0)) / versine(sin2_max);
        ++counts[n * cell_of(height, n) + cell_of(std::atan2(py, px) / (2 * pi_double) + 0.5, n)];
      }
      expect_uniform(counts, samples, "sphere at " + std::to_string(ratio) + " radii");
    }
  }
}

TEST(SphereLight, DensityIsOneOverTheSolidAngle) {
  TestRandom random(3);
  for (int i = 0; i < 200'000; ++i) {
    const Sphere sphere = distant_sphere(random, 1 + random.log_uniform(1e-4, 1e6));
    const Primitives light{&sphere, nullptr, 1, 0};
    const long double d2 =
        glm::dot(glm::tvec3<long double>(sphere.center), glm::tvec3<long double>(sphere.center));
    const long double angle = 2 * pi_double * (1 - std::sqrt(1 - sphere.radius_squared / d2));
    const LightSample s = sample_primitive(light, 0, Vec3(0.0f), random.unit(), random.unit());
    expect_consistent(light, s, Vec3(0.0f));
    ASSERT_NEAR(s.pdf * angle, 1, 1e-4);
  }
}

TEST(SphereLight, IsNotSampledFromInside) {
  const Sphere sphere{{1, 2, 3}, 4};
  for (const Vec3& from : {Vec3(1, 2, 3), Vec3(2.5f, 2, 3), Vec3(3, 2, 3)}) {
    EXPECT_EQ(sample_sphere(sphere, from, 0.5f, 0.5f).pdf, 0.0f);
    EXPECT_EQ(sphere_solid_angle_pdf(sphere, from), 0.0f);
  }
}

/// Mean of cos / pdf over light samples, for a receiver at the origin with normal `n`.
MeanEstimate sampled_irradiance(const Primitives& light, const Vec3d& n, TestRandom& random) {
  MeanEstimate estimate;
  for (int i = 0; i < 20'000; ++i) {
    const LightSample s = sample_primitive(light, 0, Vec3(0.0f), random.unit(), random.unit());
    estimate.add(s.pdf > 0 ? std::max(0.0, glm::dot(Vec3d(s.wi), n)) / s.pdf : 0);
  }
  return estimate;
}

TEST(Irradiance, FromAQuadIsLamberts) {
  TestRandom random(4);
  for (int k = 0; k < 100; ++k) {
    const Quad quad = facing_quad(random);
    const Vec3d n = random.direction();
    const auto p = corners(quad);
    if (!std::all_of(p.begin(), p.end(), [&](const Vec3d& v) { return glm::dot(v, n) > 0; }))
      continue;
    const MeanEstimate e = sampled_irradiance({nullptr, &quad, 0, 1}, n, random);
    EXPECT_NEAR(e.mean(), polygon_irradiance(quad, n), 5 * e.sigma() + 1e-5 * e.mean());
  }
}

TEST(Irradiance, FromASphereFollowsTheInverseSquare) {
  TestRandom random(5);
  for (int k = 0; k < 100; ++k) {
    const Sphere sphere = distant_sphere(random, random.log_uniform(1.05, 1e3));
    const Vec3d c(sphere.center), n = random.direction();
    if (glm::dot(c, n) < sphere.radius()) continue;
    const double exact =
        pi_double * sphere.radius_squared / glm::dot(c, c) * glm::dot(c, n) / glm::length(c);
    const MeanEstimate e = sampled_irradiance({&sphere, nullptr, 1, 0}, n, random);
    EXPECT_NEAR(e.mean(), exact, 5 * e.sigma() + 1e-5 * exact);
  }
}

TEST(Sky, IsAVerticalGradient) {
  const Sky sky{{1, 2, 3}, {5, 4, 3}};
  EXPECT_EQ(sky_radiance(sky, {0, 1, 0}), sky.zenith);
  EXPECT_EQ(sky_radiance(sky, {0, -1, 0}), sky.nadir);
  EXPECT_EQ(sky_radiance(sky, {0.6f, 0, -0.8f}), Color(3, 3, 3)) << "the horizon";
  const Color upward = sky_radiance(sky, {0.8f, 0.6f, 0});
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(upward[i], 0.2 * sky.nadir[i] + 0.8 * sky.zenith[i], 1e-6);
}

}  // namespace
}  // namespace pt
