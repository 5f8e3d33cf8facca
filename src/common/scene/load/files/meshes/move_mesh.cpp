#include "common/scene/load/files/meshes/move_mesh.h"

#include <cmath>
#include <utility>

namespace pt {
namespace {

void turn(TriangleIndices& triangle) { std::swap(triangle.v[1], triangle.v[2]); }

}  // namespace

void transform_mesh(Mesh& mesh, const Affine& map) {
  for (Vec3& position : mesh.positions) position = map.point(position);
  if (mesh.normals.empty()) return;
  const Affine back = inverse(map);
  for (Vec3& normal : mesh.normals) {
    const Vec3 moved = back.transposed(normal);
    const float length = glm::length(moved);
    if (length > 0.0f && std::isfinite(length)) normal = moved / length;
  }
}

void turn_mesh(Mesh& mesh) {
  for (Vec3& normal : mesh.normals) normal = -normal;
  for (TriangleIndices& triangle : mesh.triangles) turn(triangle);
}

void wind_by_normals(Mesh& mesh) {
  for (TriangleIndices& triangle : mesh.triangles) {
    const auto& [a, b, c] = triangle.v;
    const Vec3& p = mesh.positions[a];
    const Vec3 geometric = glm::cross(mesh.positions[b] - p, mesh.positions[c] - p);
    const Vec3 shading = mesh.normals[a] + mesh.normals[b] + mesh.normals[c];
    if (glm::dot(geometric, shading) < 0.0f) turn(triangle);
  }
}

}  // namespace pt
