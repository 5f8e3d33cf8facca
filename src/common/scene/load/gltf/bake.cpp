#include "common/scene/load/gltf/bake.h"

#include <cmath>
#include <utility>

namespace pt::gltf {

Cofactors::Cofactors(const Affine& map) {
  const Vec3 x = map.vector({1, 0, 0}), y = map.vector({0, 1, 0}), z = map.vector({0, 0, 1});
  columns[0] = glm::cross(y, z), columns[1] = glm::cross(z, x), columns[2] = glm::cross(x, y);
}

void bake(File& file, const Affine& to_world, const std::string& place, Mesh& mesh) {
  for (Vec3& p : mesh.positions) p = to_world.point(p);
  const Cofactors cofactors(to_world);
  for (Vec3& n : mesh.normals) n = cofactors.normal(n);
  finish_baking(file, to_world.determinant() < 0.0f, place, mesh);
}

void finish_baking(File& file, bool mirrors, const std::string& place, Mesh& mesh) {
  const auto overflows = [&](std::uint32_t v) {
    const Vec3& p = mesh.positions[v];
    return !std::isfinite(p.x + p.y + p.z);
  };
  const std::size_t lost = std::erase_if(mesh.triangles, [&](const TriangleIndices& t) {
    return overflows(t.v[0]) || overflows(t.v[1]) || overflows(t.v[2]);
  });
  if (lost > 0) {
    file.report(place, "a vertex in world space overflows: its triangles are left out");
    const Vec3 used = mesh.triangles.empty() ? Vec3(0.0f) : mesh.positions[mesh.triangles[0].v[0]];
    for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
      if (overflows(v)) mesh.positions[v] = used;
    }
  }
  if (mirrors) {
    for (TriangleIndices& t : mesh.triangles) std::swap(t.v[1], t.v[2]);
  }
  for (Vec3& n : mesh.normals) {
    const float length = glm::length(n);
    if (!(length > 0.0f) || !std::isfinite(length)) {
      mesh.normals.clear();
      break;
    }
    n *= (mirrors ? -1.0f : 1.0f) / length;
  }
}

}  // namespace pt::gltf
