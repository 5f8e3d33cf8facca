// Instances and rays that rounding can part: what is met in one is decided by its box in the world.
#pragma once

#include "accel/triangle_meshes.h"
#include "accel/triangle_rays.h"
#include "common/geometry/mesh.h"
#include "statistics.h"

namespace pt {

/// A square in each of the planes: boxes without thickness, and edges on the boxes' faces.
inline std::vector<Mesh> squares() {
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

inline Crowd far_crowd(TestRandom& random, float far) {
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

/// Stretched instances near the origin, seen from so far away that rounding moves their rays by
/// more than their boxes' margins; aimed at corners, which touch the boxes, or just inside.
inline Crowd crowd_from_afar(TestRandom& random, double distance) {
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

}  // namespace pt
