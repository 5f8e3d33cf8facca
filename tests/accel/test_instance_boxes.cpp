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

}  // namespace
}  // namespace pt
