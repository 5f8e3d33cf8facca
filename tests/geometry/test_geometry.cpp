// Intersections against extended precision, and that no spawned ray meets the surface it leaves.
//
// A float result is right when it is the exact result of a slightly moved surface: the tolerances
// below are distances, in units of the rounding error of the largest length involved.
#include <gtest/gtest.h>

#include "common/geometry/primitives.h"
#include "statistics.h"

namespace pt {
namespace {

using Real = long double;
using Vec3d = glm::dvec3;
using Vec3l = glm::tvec3<Real>;
constexpr Real ulp = 6e-8L;

Vec3d orthogonal_direction(TestRandom& random, const Vec3d& n) {
  return glm::normalize(glm::cross(n, random.direction()));
}

/// Half of them grazing: cosines down to 1e-7 with `n`.
Vec3d leaving_direction(TestRandom& random, const Vec3d& n) {
  const double c = random.bits() % 2 ? random.uniform(0, 1) : random.log_uniform(1e-7, 1);
  return c * n + std::sqrt(1 - c * c) * orthogonal_direction(random, n);
}

Ray ray_towards(const Vec3& origin, const Vec3d& target) {
  return {origin, Vec3(glm::normalize(target - Vec3d(origin)))};
}

Sphere random_sphere(TestRandom& random) {
  const double radius = random.log_uniform(1e-3, 1e5);
  const double distance = random.bits() % 4 ? random.log_uniform(1e-3, 1e2) * radius : 0;
  const auto r = static_cast<float>(radius);
  return {Vec3(distance * random.direction()), r * r};
}

/// From outside, near or far, or from inside; at the sphere, past it, or at its silhouette.
Ray random_ray(TestRandom& random, const Sphere& sphere) {
  const double r = sphere.radius();
  const Vec3d center(sphere.center), out = random.direction();
  const double height = random.bits() % 3 == 0   ? -random.log_uniform(1e-6, 1)
                        : random.bits() % 3 == 0 ? random.log_uniform(1e-6, 1e-3)
                                                 : random.log_uniform(1e-3, 1e3);
  const Vec3 origin(center + r * (1 + height) * out);
  const double miss = random.bits() % 3 == 0   ? 1 + random.uniform(-1e-5, 1e-5)
                      : random.bits() % 3 == 0 ? 1 + random.uniform(-1e-2, 1e-2)
                                               : random.uniform(0, 2);
  const Vec3d aim = orthogonal_direction(random, glm::normalize(Vec3d(origin) - center));
  const double side = random.bits() % 4 ? 1 : -1;  // some look away
  return {origin, Vec3(side * glm::normalize(center + r * miss * aim - Vec3d(origin)))};
}

struct Roots {
  Real near, far;  ///< distances along the ray
  Real excess;     ///< of the radius over the line's distance from the centre; < 0: missed
  Real scale;      ///< the largest length involved
};

Roots exact_roots(const Sphere& sphere, const Ray& ray) {
  const Vec3l oc = Vec3l(sphere.center) - Vec3l(ray.origin);
  const Vec3l d(ray.direction);
  const Real b = glm::dot(oc, d) / glm::dot(d, d), radius = std::sqrt(Real{sphere.radius_squared});
  const Vec3l off = oc - b * d;
  const Real half2 = (sphere.radius_squared - glm::dot(off, off)) / glm::dot(d, d);
  const Real half = std::sqrt(std::max(half2, Real{0}));
  return {b - half, b + half, radius - glm::length(off), radius + glm::length(oc)};
}

TEST(SphereIntersection, AgreesWithExtendedPrecision) {
  TestRandom random;
  int hits = 0, far_hits = 0, misses = 0, unclear = 0;
  for (int i = 0; i < 3'000'000; ++i) {
    const Sphere sphere = random_sphere(random);
    const Ray ray = random_ray(random, sphere);
    const float t = primitive_distance({&sphere, nullptr, 1, 0}, 0, ray);
    const Roots exact = exact_roots(sphere, ray);
    const Real tolerance = 8 * ulp * exact.scale;
    const Real radius = sphere.radius();
    // How far a root moves along the ray when the surface moves by the tolerance.
    const Real half = (exact.far - exact.near) / 2;
    const Real shift = tolerance + std::min(tolerance * radius / std::max(half, Real{1e-20L}),
                                            std::sqrt(2 * radius * tolerance));
    if (exact.excess < -tolerance || exact.far < -shift) {
      ASSERT_LE(t, 0.0f) << "case " << i;
      ++misses;
    } else if (exact.excess < tolerance || std::abs(exact.far) <= shift ||
               std::abs(exact.near) <= shift) {
      ++unclear;
    } else {
      const bool first = exact.near > 0;
      ASSERT_NEAR(t, first ? exact.near : exact.far, shift) << "case " << i;
      ++(first ? hits : far_hits);
    }
  }
  EXPECT_GT(hits, 500'000);
  EXPECT_GT(far_hits, 500'000);
  EXPECT_GT(misses, 500'000);
  EXPECT_LT(unclear, 1'000'000);
}

TEST(SphereIntersection, TheCentreTheAxesAndTheTangent) {
  const Sphere sphere{{1, 2, 3}, 4};
  const auto distance = [&](const Vec3& o, const Vec3& d) {
    return primitive_distance({&sphere, nullptr, 1, 0}, 0, {o, d});
  };
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 d(0.0f);
    d[axis] = 1;
    EXPECT_EQ(distance(sphere.center, d), 2.0f);
    EXPECT_EQ(distance(sphere.center - 5.0f * d, d), 3.0f);
    EXPECT_LE(distance(sphere.center + 5.0f * d, d), 0.0f);
    EXPECT_EQ(distance(sphere.center + d, -d), 3.0f);
  }
  EXPECT_EQ(distance({-4, 4, 3}, {1, 0, 0}), 5.0f) << "tangent";
  EXPECT_LE(distance({-4, 4.001f, 3}, {1, 0, 0}), 0.0f);
}

TEST(SphereSpawn, RaysThatLeaveOutsideNeverReturn) {
  TestRandom random(2);
  for (int i = 0; i < 2'000'000; ++i) {
    const Sphere sphere = random_sphere(random);
    const Ray ray = random_ray(random, sphere);
    const Primitives primitives{&sphere, nullptr, 1, 0};
    const float t = primitive_distance(primitives, 0, ray);
    if (t <= 0) continue;
    const SurfacePoint point = surface_point(primitives, ray, {t, 0});
    const Vec3l from_center = Vec3l(point.position) - Vec3l(sphere.center);
    const Real radius = std::sqrt(Real{sphere.radius_squared});
    ASSERT_NEAR(glm::length(from_center), radius, point.error_bound);
    ASSERT_LE(glm::length(from_center / radius - Vec3l(point.normal)),
              point.error_bound / radius + 4 * ulp);
    const Vec3 out(leaving_direction(random, Vec3d(point.normal)));
    if (glm::dot(out, point.normal) < 0) continue;
    ASSERT_LE(primitive_distance(primitives, 0, spawn_ray(point, out)), 0.0f) << "case " << i;
  }
}

// A ray into the sphere ends at its far side: not at once, and it does not escape.
TEST(SphereSpawn, RaysThatEnterReachTheFarSide) {
  TestRandom random(3);
  for (int i = 0; i < 2'000'000; ++i) {
    const Sphere sphere = random_sphere(random);
    const Ray ray = random_ray(random, sphere);
    const Primitives primitives{&sphere, nullptr, 1, 0};
    const float t = primitive_distance(primitives, 0, ray);
    if (t <= 0) continue;
    const SurfacePoint point = surface_point(primitives, ray, {t, 0});
    const Vec3 in(-leaving_direction(random, Vec3d(point.normal)));
    if (glm::dot(in, point.normal) >= 0) continue;
    const Ray spawned = spawn_ray(point, in);
    const Roots exact = exact_roots(sphere, spawned);
    const float next = primitive_distance(primitives, 0, spawned);
    ASSERT_LT(exact.near, 0) << "case " << i;
    ASSERT_GT(exact.far, 0) << "case " << i;
    ASSERT_NEAR(next, exact.far, exact.far / 2) << "case " << i;
  }
}

Quad random_quad(TestRandom& random) {
  const double size = random.log_uniform(1e-3, 1e5);
  const Vec3d a = size * random.direction();
  const Vec3d across = orthogonal_direction(random, glm::normalize(a));
  const Vec3d b = random.uniform(-1, 1) * a + size * random.log_uniform(1e-2, 1) * across;
  const double distance = random.bits() % 4 ? random.log_uniform(1e-2, 1e2) * size : 0;
  return make_quad(Vec3(distance * random.direction()), Vec3(a), Vec3(b));
}

Vec3d quad_point(const Quad& quad, double a, double b) {
  return Vec3d(quad.corner) + a * Vec3d(quad.edge_a) + b * Vec3d(quad.edge_b);
}

/// A ray to a point of the quad's plane, up to half an edge outside; some look away.
Ray random_ray(TestRandom& random, const Quad& quad) {
  const Vec3d target = quad_point(quad, random.uniform(-0.5, 1.5), random.uniform(-0.5, 1.5));
  const double distance = random.log_uniform(1e-3, 1e3) * std::sqrt(quad.area);
  const Vec3d side = random.bits() % 2 ? Vec3d(quad.normal) : -Vec3d(quad.normal);
  const Ray ray = ray_towards(Vec3(target + distance * leaving_direction(random, side)), target);
  return {ray.origin, random.bits() % 4 ? ray.direction : -ray.direction};
}

TEST(QuadIntersection, AgreesWithExtendedPrecision) {
  TestRandom random(4);
  int hits = 0, misses = 0;
  for (int i = 0; i < 2'000'000; ++i) {
    const Quad quad = random_quad(random);
    const Ray ray = random_ray(random, quad);
    const float t = quad_distance(quad, ray);
    const Vec3l ea(quad.edge_a), eb(quad.edge_b), n = glm::cross(ea, eb), d(ray.direction);
    const Vec3l oc = Vec3l(quad.corner) - Vec3l(ray.origin);
    const Real cosine = glm::dot(n, d) / glm::length(n);
    const Real exact = glm::dot(n, oc) / glm::dot(n, d);
    const Vec3l p = exact * d - oc;
    const Real n2 = glm::dot(n, n);
    const Vec3l dual_a = glm::cross(eb, n) / n2, dual_b = glm::cross(n, ea) / n2;
    const Real a = glm::dot(dual_a, p), b = glm::dot(dual_b, p);
    const Real scale = glm::length(oc) + std::abs(exact) + glm::length(ea) + glm::length(eb);
    const Real skew = glm::length(ea) * glm::length(eb) / glm::length(n);
    const Real tolerance = 8 * ulp * skew * scale / std::abs(cosine);
    const Real margin = 2e-6L + tolerance * (glm::length(dual_a) + glm::length(dual_b));
    const Real outside = std::max(std::max(-a, a - 1), std::max(-b, b - 1));
    if (exact < -tolerance || outside > margin) {
      ASSERT_LE(t, 0.0f) << "case " << i;
      ++misses;
    } else if (exact > tolerance && outside < -margin) {
      ASSERT_NEAR(t, exact, tolerance) << "case " << i;
      ++hits;
    }
  }
  EXPECT_GT(hits, 200'000);
  EXPECT_GT(misses, 500'000);
}

TEST(QuadIntersection, EdgesCornersAndParallelRays) {
  const Quad quad = make_quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0});
  EXPECT_EQ(quad.normal, Vec3(0, 1, 0));
  EXPECT_EQ(quad.area, 4.0f);
  for (const float x : {-1.0f, -0.5f, 1.0f}) {
    for (const float z : {-1.0f, 0.3f, 1.0f}) {
      EXPECT_EQ(quad_distance(quad, {{x, 2, z}, {0, -1, 0}}), 2.0f) << x << ' ' << z;
    }
  }
  EXPECT_LE(quad_distance(quad, {{1.001f, 2, 0}, {0, -1, 0}}), 0.0f);
  EXPECT_LE(quad_distance(quad, {{0, 2, 0}, {1, 0, 0}}), 0.0f) << "parallel";
  const float within = quad_distance(quad, {{0, 0, 0}, {1, 0, 0}});
  EXPECT_FALSE(within > 0.0f) << "in the plane";
}

TEST(QuadSpawn, RaysNeverMeetTheQuadAgain) {
  TestRandom random(5);
  for (int i = 0; i < 2'000'000; ++i) {
    const Quad quad = random_quad(random);
    const Ray ray = random_ray(random, quad);
    const Primitives primitives{nullptr, &quad, 0, 1};
    const float t = primitive_distance(primitives, 0, ray);
    if (t <= 0) continue;
    const SurfacePoint point = surface_point(primitives, ray, {t, 0});
    const Vec3l n(quad.normal);  // as stored: it and the corner are the plane
    ASSERT_LE(std::abs(glm::dot(n, Vec3l(point.position) - Vec3l(quad.corner))), point.error_bound);
    const Vec3d side = random.bits() % 2 ? Vec3d(point.normal) : -Vec3d(point.normal);
    const Ray spawned = spawn_ray(point, Vec3(leaving_direction(random, side)));
    ASSERT_LE(primitive_distance(primitives, 0, spawned), 0.0f) << "case " << i;
  }
}

TEST(Bounds, OfNothingAndOfFlatThings) {
  Bounds bounds;
  EXPECT_TRUE(bounds.is_empty());
  EXPECT_EQ(bounds.half_area(), 0.0f);
  bounds.grow(Bounds());
  EXPECT_EQ(bounds.half_area(), 0.0f);
  bounds.grow(Vec3(1, 2, 3));
  EXPECT_FALSE(bounds.is_empty());
  EXPECT_EQ(bounds.half_area(), 0.0f);
  bounds.grow(Vec3(3, -1, 3));
  EXPECT_EQ(bounds.half_area(), 6.0f);
  bounds.grow(Vec3(2, 0, 7));
  EXPECT_EQ(bounds.half_area(), 6.0f + 12 + 8);
  EXPECT_EQ(bounds.center(), Vec3(2, 0.5f, 5));
}

TEST(KeepNearer, OrderDoesNotMatter) {
  const std::vector<std::pair<float, std::uint32_t>> found = {
      {2, 7}, {2, 3}, {-1, 0}, {0, 1}, {3, 2}, {2, 5}, {std::nanf(""), 4}, {infinite_distance, 9}};
  std::vector<std::size_t> order = {0, 1, 2, 3, 4, 5, 6, 7};
  do {
    Hit hit;
    for (const std::size_t i : order) keep_nearer(hit, found[i].first, found[i].second);
    ASSERT_EQ(hit.t, 2.0f);
    ASSERT_EQ(hit.primitive, 3u);
  } while (std::next_permutation(order.begin(), order.end()));
  Hit none;
  keep_nearer(none, -0.0f, 1);
  keep_nearer(none, HUGE_VALF, 1);
  EXPECT_TRUE(none.is_miss());
}

}  // namespace
}  // namespace pt
