// Triangles by their solid angle, against sums over their area in double precision.
#include "common/light/triangle_light.h"
#include "statistics.h"

namespace pt {
namespace {

struct Corners {
  glm::dvec3 v[3];
};

/// The solid angle of a triangle as seen from the origin: the sum over small parts of it.
double summed_solid_angle(const Corners& t, int steps) {
  const glm::dvec3 e1 = (t.v[1] - t.v[0]) / double(steps), e2 = (t.v[2] - t.v[0]) / double(steps);
  const glm::dvec3 normal = 0.5 * glm::cross(e1, e2);
  double sum = 0;
  const auto add = [&](double i, double j) {
    const glm::dvec3 p = t.v[0] + i * e1 + j * e2;
    sum += std::abs(glm::dot(p, normal)) / std::pow(glm::dot(p, p), 1.5);
  };
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; i + j < steps; ++j) {
      add(i + 1 / 3.0, j + 1 / 3.0);
      if (i + j + 1 < steps) add(i + 2 / 3.0, j + 2 / 3.0);
    }
  }
  return sum;
}

SphericalTriangle as_seen(const Corners& t) {
  const Vec3 v0(t.v[0]), v1(t.v[1]), v2(t.v[2]);
  return {v0, v1, v2, glm::cross(v1 - v0, v2 - v0)};
}

Corners random_triangle(TestRandom& random, double distance) {
  Corners t;
  const glm::dvec3 to = distance * random.direction();
  for (glm::dvec3& v : t.v) v = to + random.uniform(0.2, 1) * random.direction();
  return t;
}

TEST(SphericalTriangle, SolidAngleIsThatOfItsParts) {
  TestRandom random(5);
  for (int i = 0; i < 200; ++i) {
    const Corners t = random_triangle(random, random.log_uniform(1.5, 300));
    const double expected = summed_solid_angle(t, 200);
    // An edge-on triangle's is uncertain by the rounding of its corners.
    const double size = 1 / glm::length(t.v[0]);
    ASSERT_NEAR(as_seen(t).solid_angle, expected, 2e-4 * expected + 3e-6 * size * size) << i;
  }
}

TEST(SphericalTriangle, SamplesAreUniformInSolidAngle) {
  TestRandom random(9);
  constexpr int parts = 6, samples = 60'000;
  for (int i = 0; i < 30; ++i) {
    const Corners t = random_triangle(random, random.uniform(0.3, 3));
    const SphericalTriangle seen = as_seen(t);
    if (seen.solid_angle < 0.02f) continue;
    const glm::dvec3 e1 = t.v[1] - t.v[0], e2 = t.v[2] - t.v[0], n = glm::cross(e1, e2);
    std::vector<double> counts(2 * parts * parts), expected(2 * parts * parts);
    for (int j = 0; j < samples; ++j) {
      const glm::dvec3 d(seen.sample(random.unit(), random.unit()));
      const glm::dvec3 p = glm::dot(t.v[0], n) / glm::dot(d, n) * d - t.v[0];
      const double b1 = glm::dot(glm::cross(p, e2), n) / glm::dot(n, n);
      const double b2 = glm::dot(glm::cross(e1, p), n) / glm::dot(n, n);
      ASSERT_GT(std::min({b1, b2, 1 - b1 - b2}), -1e-3) << "outside, triangle " << i;
      const std::size_t x = cell_of(b1, parts), y = cell_of(b2, parts);
      const bool upper = b1 * parts - double(x) + b2 * parts - double(y) > 1;
      ++counts[2 * (x * parts + y) + upper];
    }
    double sum = 0;
    for (int x = 0; x < parts; ++x) {
      for (int y = 0; x + y < parts; ++y) {
        const auto corner = [&](int a, int b) {
          return t.v[0] + double(a) / parts * e1 + double(b) / parts * e2;
        };
        const std::size_t cell = 2 * static_cast<std::size_t>(x * parts + y);
        const Corners lower{{corner(x, y), corner(x + 1, y), corner(x, y + 1)}};
        expected[cell] = samples * summed_solid_angle(lower, 40) / double{seen.solid_angle};
        sum += expected[cell];
        if (x + y + 1 == parts) continue;
        const Corners upper{{corner(x + 1, y + 1), corner(x, y + 1), corner(x + 1, y)}};
        expected[cell + 1] = samples * summed_solid_angle(upper, 40) / double{seen.solid_angle};
        sum += expected[cell + 1];
      }
    }
    EXPECT_NEAR(sum / samples, 1, 1e-3);
    expect_counts(counts, expected, "triangle " + std::to_string(i));
  }
}

}  // namespace
}  // namespace pt
