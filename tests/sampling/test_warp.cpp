// Do the warps give the densities that they promise? Each sample is mapped back to variables that
// are then uniform and independent, and counted on a grid of them.
#include <gtest/gtest.h>

#include "common/sampling/warp.h"
#include "statistics.h"

namespace pt {
namespace {

using Vec3d = glm::dvec3;
constexpr int sample_count = 1'000'000;

/// Angle around the z axis as a fraction of a turn.
double turn(double x, double y) { return std::atan2(y, x) / (2 * pi_double) + 0.5; }

TEST(Warp, UnitSphereIsUniform) {
  TestRandom random;
  constexpr int rows = 32, columns = 32;
  std::vector<double> counts(rows * columns);
  for (int i = 0; i < sample_count; ++i) {
    const Vec3d p(sample_unit_sphere(random.unit(), random.unit()));
    ASSERT_NEAR(glm::length(p), 1, 1e-6);
    // Archimedes: the height is uniform.
    ++counts[columns * cell_of(0.5 * (p.z + 1), rows) + cell_of(turn(p.x, p.y), columns)];
  }
  expect_uniform(counts, sample_count, "unit sphere");
}

TEST(Warp, UnitBallIsUniform) {
  TestRandom random(2);
  constexpr int n = 12;
  std::vector<double> counts(n * n * n);
  for (int i = 0; i < sample_count; ++i) {
    const Vec3d p(sample_unit_ball(random.unit(), random.unit(), random.unit()));
    const double r = glm::length(p);
    ASSERT_LE(r, 1 + 1e-6);
    if (r == 0) continue;
    ++counts[n * n * cell_of(r * r * r, n) + n * cell_of(0.5 * (p.z / r + 1), n) +
             cell_of(turn(p.x, p.y), n)];
  }
  expect_uniform(counts, sample_count, "unit ball");
}

TEST(Warp, UnitDiskIsUniform) {
  TestRandom random(3);
  constexpr int rows = 32, columns = 32;
  std::vector<double> counts(rows * columns);
  for (int i = 0; i < sample_count; ++i) {
    const Disk p = sample_unit_disk(random.unit(), random.unit());
    const double r2 = double{p.x} * p.x + double{p.y} * p.y;
    ASSERT_LE(r2, 1 + 1e-6);
    ++counts[columns * cell_of(r2, rows) + cell_of(turn(p.x, p.y), columns)];
  }
  expect_uniform(counts, sample_count, "unit disk");
}

/// Any two directions orthogonal to `n` and to each other.
void complete_frame(const Vec3d& n, Vec3d& t, Vec3d& b) {
  t = glm::normalize(glm::cross(std::abs(n.x) > 0.5 ? Vec3d(0, 1, 0) : Vec3d(1, 0, 0), n));
  b = glm::cross(n, t);
}

const Vec3 normals[] = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}, {0.36f, -0.48f, 0.8f}};

TEST(Warp, CosineHemisphereIsMalleys) {
  TestRandom random(4);
  constexpr int rows = 24, columns = 24;
  for (const Vec3& n : normals) {
    Vec3d t, b;
    complete_frame(Vec3d(n), t, b);
    std::vector<double> counts(rows * columns);
    for (int i = 0; i < sample_count / 2; ++i) {
      const Vec3d p(sample_cosine_hemisphere(n, random.unit(), random.unit()));
      const double cosine = glm::dot(p, Vec3d(n));
      ASSERT_NEAR(glm::length(p), 1, 1e-6);
      ASSERT_GE(cosine, -1e-3);
      // The distribution function of cos(theta) / pi is sin^2(theta).
      ++counts[columns * cell_of(1 - cosine * cosine, rows) +
               cell_of(turn(glm::dot(p, t), glm::dot(p, b)), columns)];
    }
    expect_uniform(counts, sample_count / 2, "cosine hemisphere");
  }
}

// The corners of the unit square, where logarithms, roots and vanishing sums live.
TEST(Warp, ExtremeNumbersGiveFiniteUnitVectors) {
  std::vector<float> extremes = {0, 0.25f, 0.5f, 0.75f, one_minus_ulp};
  for (int k = 24; k > 10; --k) {
    const float tiny = std::ldexp(1.0f, -k);
    for (const float u : {tiny, 0.5f - tiny, 0.5f + tiny, 1 - tiny}) extremes.push_back(u);
  }
  for (const float u0 : extremes) {
    for (const float u1 : extremes) {
      EXPECT_NEAR(glm::length(Vec3d(sample_unit_sphere(u0, u1))), 1, 1e-6);
      const Disk disk = sample_unit_disk(u0, u1);
      EXPECT_LE(std::hypot(disk.x, disk.y), 1 + 1e-6);
      for (const float u2 : extremes) {
        EXPECT_LE(glm::length(Vec3d(sample_unit_ball(u0, u1, u2))), 1 + 1e-6);
      }
      for (const Vec3& n : normals) {
        const Vec3 wi = sample_cosine_hemisphere(n, u0, u1);
        EXPECT_NEAR(glm::length(Vec3d(wi)), 1, 1e-6);
        EXPECT_GE(glm::dot(wi, n), -1e-3f);
      }
    }
  }
}

}  // namespace
}  // namespace pt
