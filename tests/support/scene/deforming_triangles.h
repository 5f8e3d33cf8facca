// Triangles at random places, which deform at random.
#pragma once

#include "scene/moving_room.h"
#include "statistics.h"

namespace pt {

inline Mesh deforming_triangles(TestRandom& random, std::size_t sets) {
  Mesh mesh;
  std::vector<Vec3> places;
  for (std::uint32_t i = 0; i < 400; ++i) {
    places.emplace_back(random.point(5));
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(places[i] + Vec3(random.point(0.5)));
    mesh.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}});
  }
  for (std::size_t set = 1; set < sets; ++set) {
    std::vector<Vec3>& later = mesh.later_positions.emplace_back();
    for (Vec3& place : places) {
      place += Vec3(random.point(3));
      for (int k = 0; k < 3; ++k) later.push_back(place + Vec3(random.point(0.8)));
    }
  }
  return mesh;
}

/// Where vertices are at a time in [0, 1], in double precision.
inline std::vector<Vec3> positions_at(const Mesh& mesh, double time) {
  const double at = time * double(mesh.vertex_sets() - 1);
  const auto set = std::min(static_cast<std::size_t>(at), mesh.vertex_sets() - 2);
  std::vector<Vec3> there;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const glm::dvec3 from(mesh.positions_of(set)[v]), to(mesh.positions_of(set + 1)[v]);
    there.emplace_back(from + (at - double(set)) * (to - from));
  }
  return there;
}

/// A ray among them.
inline Ray ray_among(TestRandom& random) {
  const Vec3 from(random.point(12));
  return {from, normalize(Vec3(random.point(5)) - from)};
}

}  // namespace pt
