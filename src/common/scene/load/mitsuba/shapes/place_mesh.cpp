#include "common/scene/load/mitsuba/shapes/place_mesh.h"

#include <cmath>
#include <utility>

#include "common/scene/load/files/meshes/mesh_files.h"

namespace pt::mitsuba {
namespace {

void transform_normals(Mesh& mesh, const Affine& to_world) {
  const Affine back = inverse(to_world);
  for (Vec3& normal : mesh.normals) {
    const Vec3 moved = back.transposed(normal);
    const float length = glm::length(moved);
    if (length > 0.0f && std::isfinite(length)) normal = moved / length;
  }
}

void turn(TriangleIndices& triangle) { std::swap(triangle.v[1], triangle.v[2]); }

void wind_by_normals(Mesh& mesh) {
  for (TriangleIndices& triangle : mesh.triangles) {
    const auto& [a, b, c] = triangle.v;
    const Vec3& p = mesh.positions[a];
    const Vec3 geometric = glm::cross(mesh.positions[b] - p, mesh.positions[c] - p);
    const Vec3 shading = mesh.normals[a] + mesh.normals[b] + mesh.normals[c];
    if (glm::dot(geometric, shading) < 0.0f) turn(triangle);
  }
}

}  // namespace

void place_mesh(Mesh& mesh, const Affine& to_world, bool face_normals, bool flip_normals) {
  for (Vec3& position : mesh.positions) position = to_world.point(position);
  if (face_normals) mesh.normals.clear();
  if (!mesh.normals.empty()) {
    transform_normals(mesh, to_world);
  } else if (!face_normals) {
    compute_vertex_normals(mesh);
  }
  if (flip_normals) {
    for (Vec3& normal : mesh.normals) normal = -normal;
    for (TriangleIndices& triangle : mesh.triangles) turn(triangle);
  }
  if (!mesh.normals.empty()) wind_by_normals(mesh);
}

}  // namespace pt::mitsuba
