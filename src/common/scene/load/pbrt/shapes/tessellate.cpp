#include "common/scene/load/pbrt/shapes/tessellate.h"

#include <utility>

namespace pt::pbrt {
namespace {

void add_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const Vec3 &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
  const Vec3 across = glm::cross(q - p, r - p);
  const float longest = std::max({glm::length(q - p), glm::length(r - p), glm::length(r - q)});
  // Twice the area; rounding leaves a little of none.
  if (!(glm::length(across) > 1e-6f * longest * longest)) return;
  const Vec3 normals = mesh.normals[a] + mesh.normals[b] + mesh.normals[c];
  if (glm::dot(across, normals) < 0.0f) std::swap(b, c);
  mesh.triangles.push_back({{a, b, c}});
}

}  // namespace

void tessellate(Mesh& mesh, int columns, int rows,
                const std::function<SurfacePoint(float u, float v)>& surface) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const float u = static_cast<float>(i) / static_cast<float>(columns);
      const float v = static_cast<float>(j) / static_cast<float>(rows);
      const SurfacePoint point = surface(u, v);
      mesh.positions.push_back(point.position);
      mesh.normals.push_back(point.normal);
      mesh.uvs.emplace_back(u, v);
    }
  }
  const auto at = [&](int i, int j) {
    return first + static_cast<std::uint32_t>(j * (columns + 1) + i);
  };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      add_triangle(mesh, at(i, j), at(i + 1, j), at(i + 1, j + 1));
      add_triangle(mesh, at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
}

}  // namespace pt::pbrt
