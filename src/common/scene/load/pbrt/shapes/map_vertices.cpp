#include "common/scene/load/pbrt/shapes/map_vertices.h"

#include <cmath>

namespace pt::pbrt {
namespace {

/// The same triangles, which share no vertex; without texture coordinates.
Mesh split_mesh(const Mesh& mesh) {
  Mesh split;
  for (const TriangleIndices& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(split.positions.size());
    for (const std::uint32_t v : t.v) {
      split.positions.push_back(mesh.positions[v]);
      if (!mesh.normals.empty()) split.normals.push_back(mesh.normals[v]);
    }
    split.triangles.push_back({{first, first + 1, first + 2}});
  }
  return split;
}

/// Which coordinate of a round mapping returns to where it began: around the axis.
int closed_coordinate(MappingKind kind) { return kind == MappingKind::spherical ? 1 : 0; }

/// On the axis there is no angle around it.
bool is_on_axis(const TextureMapping& mapping, const Vec3& point) {
  const Vec3 p = mapping.to_texture.point(point);
  return std::hypot(p.x, p.y) <= 1e-6f * glm::length(p);
}

/// Brings the angles of a triangle's vertices beside each other, where it lies across the seam.
void close_seam(Mesh& mesh, const TriangleIndices& triangle, const TextureMapping& mapping) {
  const int c = closed_coordinate(mapping.kind);
  float sum = 0.0f, first = 0.0f;
  int count = 0;
  for (const std::uint32_t v : triangle.v) {
    if (is_on_axis(mapping, mesh.positions[v])) continue;
    float& turn = mesh.uvs[v][c];
    if (count == 0) first = turn;
    turn -= std::round(turn - first);
    sum += turn;
    ++count;
  }
  for (const std::uint32_t v : triangle.v) {
    if (count > 0 && is_on_axis(mapping, mesh.positions[v])) {
      mesh.uvs[v][c] = sum / static_cast<float>(count);
    }
  }
}

}  // namespace

void add_default_uvs(Mesh& mesh) {
  mesh = split_mesh(mesh);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    mesh.uvs.insert(mesh.uvs.end(), {{0, 0}, {1, 0}, {1, 1}});
  }
}

void map_vertices(Mesh& mesh, const TextureMapping& mapping) {
  if (mapping.is_uv()) return;
  const bool has_seam = mapping.kind != MappingKind::planar;
  if (has_seam) mesh = split_mesh(mesh);
  mesh.uvs.clear();
  mesh.uvs.reserve(mesh.positions.size());
  for (const Vec3& p : mesh.positions) mesh.uvs.push_back(mapping.at(p));
  if (!has_seam) return;
  for (const TriangleIndices& t : mesh.triangles) close_seam(mesh, t, mapping);
}

}  // namespace pt::pbrt
