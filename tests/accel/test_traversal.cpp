// The trees of triangles give exactly what testing every triangle gives: the same distance, the
// same triangle, the same instance.
#include <gtest/gtest.h>

#include "accel/triangle_trees.h"
#include "common/accel/traverse_triangles.h"
#include "statistics.h"

namespace pt {
namespace {

using Triangles = std::vector<Triangle>;

Vec3 point_within(TestRandom& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

void add(Triangles& triangles, const Vec3& a, const Vec3& b, const Vec3& c) {
  triangles.push_back({a, static_cast<std::uint32_t>(triangles.size()), b, 0, c, 0});
}

Triangles soup(int count, float size, const Vec3& at) {
  TestRandom random(3);
  Triangles triangles;
  for (int i = 0; i < count; ++i) {
    const Vec3 v = at + point_within(random, size);
    add(triangles, v, v + point_within(random, 0.2f * size), v + point_within(random, 0.2f * size));
  }
  return triangles;
}

/// Squares with vertices on whole numbers, so that rays aimed at them hit edges and corners, and
/// boxes that are flat; every one twice, so that there are ties.
Triangles grid(int size, float scale, const Vec3& at) {
  Triangles triangles;
  for (int twice = 0; twice < 2; ++twice) {
    for (int x = 0; x < size; ++x) {
      for (int y = 0; y < size; ++y) {
        const auto p = [&](int i, int j) {
          return at + scale * Vec3(x + i, y + j, (x + i) % 3 == 0 ? 1 : 0);
        };
        add(triangles, p(0, 0), p(1, 0), p(1, 1));
        add(triangles, p(0, 0), p(1, 1), p(0, 1));
      }
    }
  }
  return triangles;
}

Ray random_ray(TestRandom& random, const Triangles& triangles, const Bounds& all) {
  const auto vertex = [&] {
    const Triangle& t = triangles[random.below(static_cast<std::uint32_t>(triangles.size()))];
    return random.bits() % 2 ? t.v0 : t.v2;
  };
  const float size = max_abs(all.max - all.min);
  Vec3 origin = all.center() + point_within(random, size);
  if (random.bits() % 4 == 0) origin = vertex();
  Vec3 direction = point_within(random, 1);
  if (random.bits() % 2 == 0) direction = vertex() - origin;
  const std::uint32_t zeros = random.bits() % 16;  // in a plane, along an axis, with either zero
  for (int i = 0; i < 3; ++i) {
    if (zeros < 8 && (zeros >> i & 1)) {
      direction[i] = random.bits() % 2 ? 0.0f : -0.0f;
      if (random.bits() % 2) origin[i] = vertex()[i];  // in the plane of a box
    }
  }
  if (!(max_abs(direction) > 0)) direction = {0, -1, 0};
  return {origin, direction};
}

template <bool instanced>
int expect_same(const TestTrees& trees, const Ray& ray, float t_min, float t_max) {
  const TriangleTree binary = trees.binary(), wide = trees.wide();
  const Hit expected = closest_triangle<Accel::brute, instanced>(binary, ray, t_min, t_max);
  const auto expect = [&](const char* name, const TriangleTree& tree, const Hit& hit, bool any) {
    SCOPED_TRACE(testing::Message()
                 << name << " from " << ray.origin.x << ' ' << ray.origin.y << ' ' << ray.origin.z
                 << " to " << ray.direction.x << ' ' << ray.direction.y << ' ' << ray.direction.z);
    EXPECT_EQ(any, !expected.is_miss());
    ASSERT_EQ(hit.is_miss(), expected.is_miss());
    if (hit.is_miss()) return;
    EXPECT_EQ(hit.t, expected.t);
    EXPECT_EQ(tree.triangles[hit.primitive].id, binary.triangles[expected.primitive].id);
    if (instanced && binary.instance_count > 0) {
      EXPECT_EQ(tree.instances[hit.instance].index, binary.instances[expected.instance].index);
    }
  };
  expect("brute", binary, expected,
         any_triangle<Accel::brute, instanced>(binary, ray, t_min, t_max));
  expect("bvh2", binary, closest_triangle<Accel::bvh2, instanced>(binary, ray, t_min, t_max),
         any_triangle<Accel::bvh2, instanced>(binary, ray, t_min, t_max));
  expect("cwbvh", wide, closest_triangle<Accel::cwbvh, instanced>(wide, ray, t_min, t_max),
         any_triangle<Accel::cwbvh, instanced>(wide, ray, t_min, t_max));
  return expected.is_miss() ? 0 : 1;
}

void test_triangles(const Triangles& triangles, int rays) {
  TestTrees trees;
  trees.add_triangles(triangles);
  Bounds all;
  for (const Triangle& t : triangles) all.grow(triangle_bounds(t.v0, t.v1, t.v2));
  TestRandom random(11);
  int hits = 0;
  for (int i = 0; i < rays; ++i) {
    const Ray ray = random_ray(random, triangles, all);
    const bool part = random.bits() % 4 == 0;
    const float t_min = part ? 0.5f : 0.0f, t_max = part ? 1.5f : infinite_distance;
    hits += expect_same<false>(trees, ray, t_min, t_max);
    // Traversal that is ready for instances also takes trees without.
    expect_same<true>(trees, ray, t_min, t_max);
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(hits, rays / 20);
}

TEST(Traversal, Soup) { test_triangles(soup(3000, 1, Vec3(0)), 3000); }
TEST(Traversal, SoupOfSmallScale) { test_triangles(soup(500, 1e-3f, Vec3(0)), 3000); }
TEST(Traversal, SoupFarFromTheOrigin) { test_triangles(soup(500, 10, Vec3(1e5f, -1e5f, 3)), 3000); }
TEST(Traversal, Grid) { test_triangles(grid(20, 1, Vec3(0)), 3000); }
TEST(Traversal, GridOfSmallScale) { test_triangles(grid(20, 1e-3f, Vec3(0)), 3000); }
TEST(Traversal, GridFarFromTheOrigin) { test_triangles(grid(20, 0.37f, Vec3(1e5f, 0, 0)), 3000); }
TEST(Traversal, OneTriangle) { test_triangles(soup(1, 1, Vec3(0)), 500); }
TEST(Traversal, NineTriangles) { test_triangles(soup(9, 1, Vec3(0)), 500); }

/// Boxes and triangles seen from 1e5 times their size.
TEST(Traversal, RaysFromFarAway) {
  const Triangles triangles = soup(500, 1, Vec3(0));
  TestTrees trees;
  trees.add_triangles(triangles);
  TestRandom random(5);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 origin = 1e5f * normalize(point_within(random, 1));
    hits += expect_same<false>(trees, {origin, normalize(point_within(random, 1) - origin)}, 0,
                               infinite_distance);
  }
  EXPECT_GT(hits, 100);
}

/// A closed box around the origin leaves no gap, also along its edges and in its corners.
TEST(Traversal, IsWatertight) {
  const Triangles floor = grid(15, 1, Vec3(-7.5f, -7.5f, -3));
  TestTrees trees;
  trees.add_triangles(floor);
  TestRandom random(6);
  for (int i = 0; i < 5000; ++i) {
    const Triangle& t = floor[random.below(static_cast<std::uint32_t>(floor.size()))];
    if (max_abs(t.v0 - Vec3(0, 0, -3)) > 6 || max_abs(t.v1 - Vec3(0, 0, -3)) > 6) continue;
    const Vec3 origin = point_within(random, 1);
    const Ray ray{origin, t.v0 + random.unit() * (t.v1 - t.v0) - origin};
    EXPECT_EQ(expect_same<false>(trees, ray, 0, infinite_distance), 1);
  }
}

TEST(Traversal, RaysThatAreNoneMissEverything) {
  TestTrees trees;
  trees.add_triangles(soup(500, 1, Vec3(0)));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  for (const Ray& ray :
       {Ray{{nan, 0, 0}, {0, 0, 1}}, Ray{{0, 0, 0}, {0, nan, 1}}, Ray{{0, 0, 0}, {0, 0, 0}},
        Ray{{0, 0, 0}, {inf, 0, 0}}, Ray{{0, inf, 0}, {0, 0, 1}}}) {
    EXPECT_EQ(expect_same<false>(trees, ray, 0, infinite_distance), 0);
  }
  const TestTrees nothing;
  EXPECT_EQ(expect_same<true>(nothing, {{0, 0, 0}, {0, 0, 1}}, 0, infinite_distance), 0);
  EXPECT_EQ(expect_same<false>(nothing, {{0, 0, 0}, {0, 0, 1}}, 0, infinite_distance), 0);
}

struct Group {
  TestTrees::Order order;
  Bounds bounds;
  std::uint32_t first_slot, slot_count;
};

Group add_group(TestTrees& trees, Triangles triangles, std::uint32_t first_id) {
  Group group;
  for (Triangle& t : triangles) {
    t.id += first_id;
    group.bounds.grow(triangle_bounds(t.v0, t.v1, t.v2));
  }
  group.first_slot = static_cast<std::uint32_t>(trees.binary_triangles.size());
  group.slot_count = static_cast<std::uint32_t>(triangles.size());
  group.order = trees.add_triangles(triangles);
  return group;
}

Affine random_placement(TestRandom& random) {
  const Vec3 stretch = Vec3(0.3f) + random.unit() * Vec3(1, 2, 0.5f);
  const Vec3 mirror(random.bits() % 2 ? 1 : -1, 1, 1);
  return translate(point_within(random, 6)) *
         rotate(point_within(random, 1) + Vec3(0, 0, 2), 360.0f * random.unit()) *
         scale(stretch * mirror);
}

TEST(Traversal, Instances) {
  TestTrees trees;
  const Group groups[] = {add_group(trees, soup(100, 1, Vec3(0)), 0),
                          add_group(trees, grid(4, 0.5f, Vec3(0)), 100),
                          add_group(trees, soup(1, 1, Vec3(0)), 164)};
  TestRandom random(8);
  std::vector<InstanceRecord> binary, wide;
  std::vector<Bounds> bounds;
  for (std::uint32_t i = 0; i < 50; ++i) {
    const Group& group = groups[i % 3];
    const Affine to_world = random_placement(random);
    Bounds box;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 p = to_world.point({corner & 1 ? group.bounds.min.x : group.bounds.max.x,
                                     corner & 2 ? group.bounds.min.y : group.bounds.max.y,
                                     corner & 4 ? group.bounds.min.z : group.bounds.max.z});
      box.grow({p - Vec3(1e-4f), p + Vec3(1e-4f)});
    }
    for (int twice = 0; twice < 2; ++twice) {  // ties between instances
      const std::uint32_t index = 99 - (2 * i + static_cast<std::uint32_t>(twice));
      const InstanceRecord record{inverse(to_world), group.order.binary_root, index,
                                  group.first_slot,  group.slot_count,        box};
      binary.push_back(record);
      wide.push_back(record);
      wide.back().root = group.order.wide_root;
      bounds.push_back(box);
    }
  }
  const TestTrees::Order order = trees.add(bounds, 1, 0, 0);
  trees.binary_root = order.binary_root;
  trees.wide_root = order.wide_root;
  for (const std::uint32_t i : order.binary) trees.binary_instances.push_back(binary[i]);
  for (const std::uint32_t i : order.wide) trees.wide_instances.push_back(wide[i]);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    Ray ray{point_within(random, 8), point_within(random, 1)};
    if (i % 4 == 0) ray.direction[i / 4 % 3] = 0;
    hits += expect_same<true>(trees, ray, 0, infinite_distance);
    if (HasFailure()) return;
  }
  EXPECT_GT(hits, 200);
}

}  // namespace
}  // namespace pt
