#include "common/scene/load/gltf/bake.h"

#include <utility>

namespace pt::gltf {

void bake(const File& file, const Affine& to_world, const std::string& place, Mesh& mesh) {
  for (Vec3& p : mesh.positions) {
    p = to_world.point(p);
    if (!std::isfinite(p.x + p.y + p.z)) file.fail(place, "a vertex in world space overflows");
  }
  const bool mirrors = to_world.determinant() < 0.0f;
  if (mirrors) {
    for (TriangleIndices& t : mesh.triangles) std::swap(t.v[1], t.v[2]);
  }
  // Normals go with the cofactors: the inverse's transpose up to a factor, and without a division
  // that a flattened mesh would not survive.
  const Vec3 x = to_world.vector({1, 0, 0}), y = to_world.vector({0, 1, 0}),
             z = to_world.vector({0, 0, 1});
  const Vec3 columns[3] = {glm::cross(y, z), glm::cross(z, x), glm::cross(x, y)};
  for (Vec3& n : mesh.normals) {
    const Vec3 moved = n.x * columns[0] + n.y * columns[1] + n.z * columns[2];
    const float length = glm::length(moved);
    if (!(length > 0.0f) || !std::isfinite(length)) {
      mesh.normals.clear();
      break;
    }
    n = (mirrors ? -1.0f : 1.0f) / length * moved;
  }
}

}  // namespace pt::gltf
