// A world of many groups, some of several meshes, for the builders of both devices.
#pragma once

#include "accel/triangle_meshes.h"
#include "common/geometry/mesh.h"
#include "common/rays/ray_file.h"

namespace pt {

struct InstancedMeshes {
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
};

/// `groups` groups of one triangle up to some hundreds, in the order of nobody's convenience, each
/// placed twice and mirrored once; besides, a group that is not used, one without triangles, and
/// meshes of the world.
inline InstancedMeshes make_instanced_meshes(std::uint32_t groups) {
  TestRandom random(21);
  InstancedMeshes world;
  const auto add_mesh = [&](int triangles, std::uint32_t group) {
    world.meshes.push_back(make_soup(triangles, 4, {}, world.meshes.size() + 1));
    world.meshes.back().group = group;
  };
  add_mesh(40, groups + 7);  // not used
  add_mesh(50, 0);
  for (std::uint32_t i = 0; i < groups; ++i) {
    const std::uint32_t group = 1 + i * 7 % groups;
    add_mesh(1 + static_cast<int>(random.below(i % 10 == 0 ? 400 : 12)), group);
    if (i % 3 == 0) add_mesh(2, 1 + i * 5 % groups);
    for (const float mirror : {1.0f, -1.0f}) {
      const Vec3 stretch = {0.1f + 0.2f * random.unit(), 0.1f + 0.1f * random.unit(),
                            0.2f * mirror};
      world.instances.push_back({group, translate(point_in_cube(random, 40)) *
                                            rotate(point_in_cube(random, 1), 50) * scale(stretch)});
    }
  }
  add_mesh(60, 0);
  world.instances.push_back({groups + 1, {}});  // nothing
  return world;
}

/// Through such a world, some of them short.
inline RaySet rays_through(int count, RayType type) {
  TestRandom random(5);
  RaySet rays;
  rays.type = type;
  for (int i = 0; i < count; ++i) {
    const Vec3 from = point_in_cube(random, 60), to = point_in_cube(random, i % 2 == 0 ? 8 : 40);
    rays.rays.push_back({from, 0.0f, to - from, i % 8 < 2 ? 1.0f : infinite_distance});
  }
  return rays;
}

}  // namespace pt
