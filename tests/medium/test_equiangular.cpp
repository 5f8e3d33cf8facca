// Distances that a light at a point chooses: they follow their density, which is that of uniform
// angles, in double precision.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/medium/distance_sampling.h"
#include "statistics.h"

namespace pt {
namespace {

struct EquiangularCase {
  glm::dvec3 point;
  float t_max;
};

/// Along +x from (1, 2, 3).
const Ray equiangular_ray{Vec3(1, 2, 3), Vec3(1, 0, 0)};
const EquiangularCase equiangular_cases[] = {{{2, 2, 4}, 3},
                                             {{1, 2.5, 3}, 3},
                                             {{-1, 3, 3}, 2},
                                             {{9, 2, 3.1}, 2},
                                             {{2, 2.01, 3}, 4},
                                             {{2, 2, 4}, infinite_distance},
                                             {{0, 3, 3}, infinite_distance}};

TEST(EquiangularSampling, DistancesHaveUniformAngles) {
  constexpr int samples = 200'000, cells = 50;
  for (const auto& [point, t_max] : equiangular_cases) {
    SCOPED_TRACE(fmt::format("{}, {}, {} to {}", point.x, point.y, point.z, t_max));
    const Equiangular towards(equiangular_ray, t_max, Vec3(point));
    const double nearest = point.x - 1, across = std::hypot(point.y - 2, point.z - 3);
    const auto angle = [&](double t) { return std::atan((t - nearest) / across); };
    const double begin = angle(0), range = angle(double{t_max}) - begin;
    TestRandom random(101);
    std::vector<double> counts(cells);
    for (int i = 0; i < samples; ++i) {
      const float t = towards.sample(random.unit());
      ASSERT_GE(t, 0);
      ASSERT_LE(t, t_max * 1.0001f);
      ++counts[cell_of((angle(double{t}) - begin) / range, cells)];
      const double from_nearest = double{t} - nearest;
      const double expected = across / range / (across * across + from_nearest * from_nearest);
      ASSERT_NEAR(towards.pdf(t), expected, 1e-3 * expected);
    }
    expect_uniform(counts, samples, "angles");
    EXPECT_EQ(towards.pays(), range > 1.57);
  }
}

TEST(EquiangularSampling, APointOnTheRayIsNoPole) {
  const Equiangular towards(equiangular_ray, 5, Vec3(3, 2, 3));
  TestRandom random(102);
  for (int i = 0; i < 1000; ++i) {
    const float t = towards.sample(random.unit());
    EXPECT_TRUE(t >= 0 && t <= 5.001f);
    EXPECT_TRUE(std::isfinite(towards.pdf(t)));
    EXPECT_GT(towards.pdf(t), 0);
  }
}

}  // namespace
}  // namespace pt
