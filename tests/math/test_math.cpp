// The arithmetic below everything else, against double precision and integer division.
#include <gtest/gtest.h>

#include <limits>

#include "common/math/functions.h"
#include "common/math/transform.h"
#include "common/sampling/mis.h"
#include "statistics.h"

namespace pt {
namespace {

using Vec3d = glm::dvec3;

void expect_sincos(float u) {
  const SinCos value = sincos_2pi(u);
  ASSERT_NEAR(value.sin, std::sin(2 * pi_double * u), 3e-7) << "u = " << u;
  ASSERT_NEAR(value.cos, std::cos(2 * pi_double * u), 3e-7) << "u = " << u;
}

TEST(SinCos, WithinItsBoundOnTheWholeTurn) {
  for (int i = 0; i <= 1 << 21; ++i) expect_sincos(static_cast<float>(i) * 0x1p-21f);
  for (int eighth = 0; eighth <= 8; ++eighth) {  // the polynomials change at odd eighths
    float below = static_cast<float>(eighth) / 8, above = below;
    for (int i = 0; i < 1000; ++i) {
      expect_sincos(below), expect_sincos(above);
      below = std::max(0.0f, std::nextafter(below, -1.0f));
      above = std::min(1.0f, std::nextafter(above, 2.0f));
    }
  }
  for (float u = 1e-3f; u > 0; u *= 0.37f) expect_sincos(u);
}

TEST(SinCos, QuarterTurnsAreExact) {
  const float expected[5][2] = {{0, 1}, {1, 0}, {0, -1}, {-1, 0}, {0, 1}};
  for (int quarter = 0; quarter <= 4; ++quarter) {
    const SinCos value = sincos_2pi(static_cast<float>(quarter) / 4);
    EXPECT_EQ(value.sin, expected[quarter][0]);
    EXPECT_EQ(value.cos, expected[quarter][1]);
  }
}

void expect_orthonormal(const Vec3& n) {
  const Frame frame = make_frame(n);
  const Vec3d t(frame.tangent), b(frame.bitangent), z(frame.normal);
  EXPECT_EQ(frame.normal, n);
  for (const double defect : {glm::length(t) - 1, glm::length(b) - 1, glm::dot(t, b),
                              glm::dot(t, z), glm::dot(b, z), glm::length(glm::cross(t, b) - z)}) {
    ASSERT_NEAR(defect, 0, 1e-6) << n.x << ' ' << n.y << ' ' << n.z;
  }
  ASSERT_NEAR(glm::length(Vec3d(frame.to_world({0.5f, -2, 3})) - (0.5 * t - 2.0 * b + 3.0 * z)), 0,
              1e-6);
}

TEST(Frame, IsOrthonormalAndRightHanded) {
  for (const float sign : {1.0f, -1.0f}) {
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 n(0.0f);
      n[axis] = sign;
      expect_orthonormal(n);
      for (float small = 0.1f; small > 1e-30f; small *= 0.03f) {
        for (int other = 0; other < 3; ++other) {
          Vec3 tilted = n;
          tilted[other] += small;
          expect_orthonormal(normalize(tilted));
          tilted[other] -= 2 * small;
          expect_orthonormal(normalize(tilted));
        }
      }
    }
  }
  expect_orthonormal({1, 0, -0.0f});
  TestRandom random;
  for (int i = 0; i < 500'000; ++i) expect_orthonormal(Vec3(random.direction()));
}

TEST(FastDivider, EqualsDivision) {
  constexpr std::uint32_t end = 1u << 31;
  EXPECT_EQ(FastDivider().quotient(end - 1), end - 1);
  for (std::uint32_t d = 1; d <= 3000; ++d) {
    const FastDivider divider(d);
    EXPECT_EQ(divider.divisor(), d);
    for (std::uint32_t n = 0; n < 3000; ++n) {
      ASSERT_EQ(divider.quotient(n), n / d) << n << " / " << d;
      ASSERT_EQ(divider.quotient(end - 1 - n), (end - 1 - n) / d) << end - 1 - n << " / " << d;
    }
  }
}

TEST(FastDivider, EdgesAndRandomDivisors) {
  constexpr std::uint32_t end = 1u << 31;
  TestRandom random;
  std::vector<std::uint32_t> divisors;
  for (int bit = 1; bit <= 31; ++bit) {
    for (const std::uint32_t d : {(1u << bit) - 1, 1u << bit, (1u << bit) + 1}) {
      if (d < end) divisors.push_back(d);
    }
  }
  for (int i = 0; i < 20'000; ++i) divisors.push_back(1 + random.below(end >> random.below(31)));
  for (const std::uint32_t d : divisors) {
    const FastDivider divider(d);
    // The quotient steps at the multiples, and its error grows with n: the last one decides.
    const std::uint32_t last = (end - 1) / d * d;
    for (const std::uint32_t n : {0u, d - 1, d, end - 1, last, last - 1}) {
      ASSERT_EQ(divider.quotient(n), n / d) << n << " / " << d;
    }
    for (int i = 0; i < 100; ++i) {
      const std::uint32_t n = random.below(end);
      ASSERT_EQ(divider.quotient(n), n / d) << n << " / " << d;
    }
  }
}

TEST(Normalize, UnitLengthAtEveryScale) {
  TestRandom random;
  for (int i = 0; i < 500'000; ++i) {
    const auto scale = static_cast<float>(random.log_uniform(1e-16, 1e18));
    Vec3 v;  // components of different sizes
    for (int k = 0; k < 3; ++k) v[k] = scale * static_cast<float>(random.uniform(-1, 1));
    v[static_cast<int>(random.below(3))] *= static_cast<float>(random.log_uniform(1e-6, 1));
    const Vec3d exact = Vec3d(v) / glm::length(Vec3d(v));
    ASSERT_LE(glm::length(Vec3d(normalize(v)) - exact), 4 * half_ulp);
  }
}

TEST(MaxAbs, IsTheLargestMagnitude) {
  EXPECT_EQ(max_abs({1, -3, 2}), 3.0f);
  EXPECT_EQ(max_abs({-4, 3, 2}), 4.0f);
  EXPECT_EQ(max_abs({0, 0.5f, -7}), 7.0f);
}

TEST(PowerHeuristic, WeightsOfTwoStrategiesSumToOne) {
  TestRandom random;
  for (int i = 0; i < 500'000; ++i) {
    const auto a = static_cast<float>(random.log_uniform(1e-15, 1e15));
    const auto b = a * static_cast<float>(random.log_uniform(1e-4, 1e4));
    const double expected = 1 / (1 + (double{b} / a) * (double{b} / a));
    ASSERT_NEAR(power_heuristic(a, b), expected, 3e-7 * expected + 1e-30);
    ASSERT_NEAR(power_heuristic(a, b) + power_heuristic(b, a), 1, 2e-7);
  }
}

TEST(PowerHeuristic, DeltasAndZeros) {
  EXPECT_EQ(power_heuristic(HUGE_VALF, 1), 1.0f);
  EXPECT_EQ(power_heuristic(HUGE_VALF, 0), 1.0f);
  EXPECT_EQ(power_heuristic(1, HUGE_VALF), 0.0f);
  EXPECT_EQ(power_heuristic(1, 0), 1.0f);
  EXPECT_EQ(power_heuristic(0, 1), 0.0f);
  EXPECT_EQ(power_heuristic(0, 0), 0.0f);
}

// The densities of small far lights and of narrow lobes have squares beyond the floats.
TEST(PowerHeuristic, SquaresMayLeaveTheRangeOfFloats) {
  EXPECT_NEAR(power_heuristic(1e25f, 1), 1, 1e-6);
  EXPECT_NEAR(power_heuristic(1e25f, 1e25f), 0.5, 1e-6);
  EXPECT_NEAR(power_heuristic(1, 1e25f), 0, 1e-6);
  EXPECT_NEAR(power_heuristic(1e-25f, 1e-25f), 0.5, 1e-6);
}

TEST(Affine, DeterminantIsThatOfTheColumns) {
  TestRandom random(9);
  for (int k = 0; k < 100; ++k) {
    Affine m;
    for (Vec4& row : m.row) {
      for (int j = 0; j < 4; ++j) row[j] = 2 * random.unit() - 1;
    }
    const Vec3 x = m.vector({1, 0, 0}), y = m.vector({0, 1, 0}), z = m.vector({0, 0, 1});
    EXPECT_NEAR(m.determinant(), glm::dot(glm::dvec3(x), glm::cross(glm::dvec3(y), glm::dvec3(z))),
                1e-5);
  }
}

TEST(Affine, IsInvertibleWhereTheWayBackIsOneInSinglePrecision) {
  TestRandom random(10);
  const float huge = std::numeric_limits<float>::max(), none = std::nanf("");
  const auto turned = [&] { return rotate({1, 2, 3}, 360 * random.unit()); };
  for (int k = 0; k < 100; ++k) {
    const float size = std::pow(10.0f, 24 * random.unit() - 12);
    const Affine map = turned() * scale(Vec3(size, 2 * size, -size)) * turned();
    ASSERT_TRUE(is_invertible(map)) << size;
    const Vec3 p(random.unit(), random.unit(), random.unit());
    EXPECT_LT(glm::length(inverse(map).point(map.point(p)) - p), 1e-5f);
  }
  for (const Affine& map :
       {scale({1, 0, 1}), scale({1, none, 1}), scale({1, huge, 1}), scale({huge, 1, 1 / huge}),
        scale(Vec3(1e15f)), translate({huge, 0, 0}), translate({0, none, 0}),
        translate({1e10f, 0, 0}) * scale({1e-10f, 1, 1})})
    EXPECT_FALSE(is_invertible(map)) << map.row[0].x;
}

}  // namespace
}  // namespace pt
