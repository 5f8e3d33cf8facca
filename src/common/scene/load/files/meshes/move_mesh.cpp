#include "common/scene/load/files/meshes/move_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/bounds.h"

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

Mesh back_of(const Mesh& mesh) {
  Mesh back = mesh;
  turn_mesh(back);
  Bounds bounds;
  for (const Vec3& p : mesh.positions) bounds.grow(p);
  const float extent = glm::length(bounds.max - bounds.min);
  const float reach = std::max(max_abs(bounds.min), max_abs(bounds.max));
  const float offset = std::max(1e-5f * extent, 4e-6f * reach);
  std::vector<Vec3> normals(mesh.positions.size(), Vec3(0.0f));
  for (const TriangleIndices& t : back.triangles) {
    const Vec3& p = back.positions[t.v[0]];
    const Vec3 n = glm::cross(back.positions[t.v[1]] - p, back.positions[t.v[2]] - p);
    for (const std::uint32_t v : t.v) normals[v] += n;
  }
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const float length = glm::length(normals[i]);
    if (length > 0.0f) back.positions[i] += (offset / length) * normals[i];
  }
  return back;
}

std::optional<float> uniform_scale(const Affine& map) {
  const Vec3 columns[3] = {map.vector({1, 0, 0}), map.vector({0, 1, 0}), map.vector({0, 0, 1})};
  const float scale = glm::length(columns[0]);
  for (int i = 0; i < 3; ++i) {
    const Vec3& next = columns[(i + 1) % 3];
    if (std::abs(glm::dot(columns[i], next)) > 1e-4f * scale * scale) return std::nullopt;
    if (std::abs(glm::length(next) - scale) > 1e-4f * scale) return std::nullopt;
  }
  return scale > 0.0f ? std::optional(scale) : std::nullopt;
}

}  // namespace pt
