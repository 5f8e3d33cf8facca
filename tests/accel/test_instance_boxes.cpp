// Boxes of instances hold what their rays meet in object space, also where coordinates are large
// beside the instance: then a box without a margin is missed by rays that its triangles meet.
#include <gtest/gtest.h>

#include "accel/instance_crowds.h"
#include "accel/tree_kinds.h"

namespace pt {
namespace {

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
