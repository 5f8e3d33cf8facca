// Boxes of instances hold what their rays meet in object space, also where coordinates are large
// beside the instance: then a box without a margin is missed by rays that its triangles meet.
#include <gtest/gtest.h>

#include "statistics.h"
#include "tree_kinds.h"
#include "triangle_meshes.h"
#include "triangle_rays.h"

namespace pt {
namespace {

/// A square in each of the planes: boxes without thickness, and edges on the boxes' faces.
std::vector<Mesh> squares() {
  std::vector<Mesh> meshes(3);
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    Mesh& mesh = meshes[axis];
    for (int i = 0; i < 4; ++i) {
      Vec3 p(0.0f);
      p[(axis + 1) % 3] = i == 1 || i == 2 ? 1.0f : -1.0f;
      p[(axis + 2) % 3] = i >= 2 ? 1.0f : -1.0f;
      mesh.positions.push_back(p);
    }
    mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
    mesh.group = axis + 1;
  }
  return meshes;
}

struct Crowd {
  std::vector<Instance> instances;
  std::vector<Ray> rays;  ///< from nearby, at corners, edges and along faces
};

Crowd far_crowd(TestRandom& random, float far) {
  Crowd crowd;
  const std::vector<Mesh> meshes = squares();
  for (int i = 0; i < 12; ++i) {
    const std::uint32_t group = 1 + random.below(3);
    const Vec3 place = far * Vec3(random.direction()) + point_in_cube(random, 8);
    Affine to_world = translate(place) * scale(Vec3(0.5f + random.unit()));
    if (i % 3 == 1) to_world = to_world * rotate(Vec3(random.direction()), 70);
    // Stretched in a direction that is no axis: rounding in object space is stretched, too.
    if (i % 3 == 2) {
      to_world = to_world * rotate(Vec3(random.direction()), 50) * scale({60, 1, 0.5f}) *
                 rotate(Vec3(random.direction()), 110);
    }
    crowd.instances.push_back({group, to_world});
    const Mesh& mesh = meshes[group - 1];
    for (int k = 0; k < 1000; ++k) {
      const Vec3 a = mesh.positions[random.below(4)], b = mesh.positions[random.below(4)];
      const Vec3 to = to_world.point(a + (k % 4 == 0 ? 0.0f : random.unit()) * (b - a));
      const Vec3 from = k % 3 == 0 ? to_world.point(2.0f * b - a) : to + point_in_cube(random, 3);
      crowd.rays.push_back(ray_to(from, to));
    }
  }
  return crowd;
}

TEST(InstanceBoxes, HoldWhatRaysMeetFarFromTheOrigin) {
  TestRandom random(31);
  const std::vector<Mesh> meshes = squares();
  for (const float far : {0.0f, 1e2f, 1e4f, 1e6f}) {
    const Crowd crowd = far_crowd(random, far);
    const TriangleTreeData brute = brute_kind.build(meshes, crowd.instances);
    for (const TreeKind& kind : {tree_kinds[0], tree_kinds[2]}) {
      const TriangleTreeData tree = kind.build(meshes, crowd.instances);
      int hits = 0, lost = 0;
      for (const Ray& ray : crowd.rays) {
        const Hit expected = closest_hit(brute, ray), found = closest_hit(tree, ray);
        hits += !expected.is_miss();
        lost += found.t != expected.t;
      }
      EXPECT_GT(hits, 2000) << kind.name << " at " << far;
      EXPECT_EQ(lost, 0) << kind.name << " at " << far << ", of " << hits << " hits";
    }
  }
}

/// Stretched instances near the origin, seen from so far away that rounding moves their rays by
/// more than their boxes' margins; aimed at corners, which touch the boxes, or just inside.
Crowd crowd_from_afar(TestRandom& random, double distance) {
  Crowd crowd;
  const std::vector<Mesh> meshes = squares();
  for (std::uint32_t i = 0; i < 12; ++i) {
    const Mesh& mesh = meshes[i % 3];
    const Affine to_world = translate(point_in_cube(random, 8)) *
                            rotate(Vec3(random.direction()), 50) * scale({30, 1, 0.03f}) *
                            rotate(Vec3(random.direction()), 110);
    crowd.instances.push_back({mesh.group, to_world});
    for (int k = 0; k < 1000; ++k) {
      const float inside = 1 - static_cast<float>(random.log_uniform(1e-7, 1));
      const Vec3 to = to_world.point(inside * mesh.positions[random.below(4)]);
      crowd.rays.push_back(ray_to(Vec3(distance * random.direction()), to));
    }
  }
  return crowd;
}

/// Where the ray is in the box, in double precision.
bool is_inside(const Bounds& box, const Ray& ray, double t, double tolerance) {
  for (int i = 0; i < 3; ++i) {
    const double a = (double{box.min[i]} - ray.origin[i]) / ray.direction[i];
    const double b = (double{box.max[i]} - ray.origin[i]) / ray.direction[i];
    if (t < std::min(a, b) - tolerance * t || t > std::max(a, b) + tolerance * t) return false;
  }
  return true;
}

// A plane's distance takes three roundings.
TEST(InstanceBoxes, NothingIsMetOutsideOfThem) {
  TestRandom random(32);
  const std::vector<Mesh> meshes = squares();
  for (const double distance : {1e4, 1e6}) {
    const Crowd crowd = crowd_from_afar(random, distance);
    for (const TreeKind& kind : {brute_kind, tree_kinds[0], tree_kinds[2]}) {
      const TriangleTreeData tree = kind.build(meshes, crowd.instances);
      int hits = 0, outside = 0;
      for (const Ray& ray : crowd.rays) {
        const Hit hit = closest_hit(tree, ray);
        if (hit.is_miss()) continue;
        ++hits;
        const Bounds& box = tree.instances[hit.instance].bounds;
        outside += !is_inside(box, ray, hit.t, 4.0 * double{half_ulp});
      }
      EXPECT_GT(hits, 2000) << kind.name << " at " << distance;
      EXPECT_EQ(outside, 0) << kind.name << " at " << distance << ", of " << hits << " hits";
    }
  }
}

// What rounding puts behind an instance's box counts as lying at its end, so it is there for a
// shadow ray that ends just behind the box.
TEST(InstanceBoxes, WhatIsMetAtTheirEndBlocksShadowRays) {
  TestRandom random(33);
  const std::vector<Mesh> meshes = squares();
  for (const double distance : {1e4, 1e6}) {
    const Crowd crowd = crowd_from_afar(random, distance);
    const TriangleTreeData brute = brute_kind.build(meshes, crowd.instances);
    for (const TreeKind& kind : {brute_kind, tree_kinds[0], tree_kinds[2]}) {
      const TriangleTreeData tree = kind.build(meshes, crowd.instances);
      int different = 0, lost = 0;
      for (const Ray& ray : crowd.rays) {
        const Hit hit = closest_hit(brute, ray);
        different += closest_hit(tree, ray).t != hit.t;
        if (hit.is_miss()) continue;
        lost += !any_hit(tree, ray, 0.0f, std::nextafterf(hit.t, infinite_distance));
      }
      EXPECT_EQ(different, 0) << kind.name << " at " << distance;
      EXPECT_EQ(lost, 0) << kind.name << " at " << distance;
    }
  }
}

}  // namespace
}  // namespace pt
