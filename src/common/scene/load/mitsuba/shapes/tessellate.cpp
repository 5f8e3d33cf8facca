#include "common/scene/load/mitsuba/shapes/tessellate.h"

#include <cmath>

#include "common/scene/load/mitsuba/shapes/box_faces.h"

namespace pt::mitsuba {
namespace {

/// cos and sin of 2 pi i / n, exact where the circle closes.
Vec2 on_circle(int i, int n) {
  const double angle = 2.0 * std::acos(-1.0) * (i % n) / n;
  return {std::cos(angle), std::sin(angle)};
}

void add_vertex(Mesh& mesh, const Vec3& position, const Vec3& normal, float u, float v) {
  mesh.positions.push_back(position);
  mesh.normals.push_back(normal);
  mesh.uvs.emplace_back(u, 1.0f - v);
}

/// A grid of `columns` x `rows` cells over vertices stored row by row, columns + 1 a row, facing
/// where rows go down and columns to the right. `skip_ends`: the first and last row are poles.
void add_grid(Mesh& mesh, int columns, int rows, bool skip_ends) {
  const auto at = [&](int column, int row) {
    return static_cast<std::uint32_t>(row * (columns + 1) + column);
  };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const std::uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      if (!(skip_ends && j == 0)) mesh.triangles.push_back({{a, c, b}});
      if (!(skip_ends && j == rows - 1)) mesh.triangles.push_back({{a, d, c}});
    }
  }
}

void add_face(Mesh& mesh, const BoxFace& face) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const Vec3 normal = 0.25f * glm::cross(face.edge_a, face.edge_b);
  for (int i = 0; i < 4; ++i) {
    const float a = i == 1 || i == 2 ? 1.0f : 0.0f, b = i >= 2 ? 1.0f : 0.0f;
    add_vertex(mesh, face.corner + a * face.edge_a + b * face.edge_b, normal,
               face.uv_swapped ? b : a, face.uv_swapped ? a : b);
  }
  mesh.triangles.push_back({{first, first + 1, first + 2}});
  mesh.triangles.push_back({{first, first + 2, first + 3}});
}

}  // namespace

Mesh tessellate_sphere() {
  Mesh mesh;
  for (int j = 0; j <= meridian_segments; ++j) {
    const float v = static_cast<float>(j) / meridian_segments;
    Vec2 ring = on_circle(j, 2 * meridian_segments);  // cos and sin of the angle from the pole
    if (j == meridian_segments) ring.y = 0.0f;
    for (int i = 0; i <= circle_segments; ++i) {
      const Vec2 around = on_circle(i, circle_segments);
      const Vec3 p(ring.y * around.x, ring.y * around.y, ring.x);
      add_vertex(mesh, p, p, static_cast<float>(i) / circle_segments, v);
    }
  }
  add_grid(mesh, circle_segments, meridian_segments, true);
  return mesh;
}

Mesh tessellate_disk(int rings) {
  Mesh mesh;
  const Vec3 up(0, 0, 1);
  const auto radius_of = [&](int row) {
    return static_cast<float>(std::pow(0.95, rings - 1 - row));
  };
  for (int j = 0; j < rings && rings > 1; ++j) {
    for (int i = 0; i <= circle_segments; ++i) {
      const Vec2 p = radius_of(j) * on_circle(i, circle_segments);
      add_vertex(mesh, Vec3(p, 0.0f), up, radius_of(j), static_cast<float>(i) / circle_segments);
    }
  }
  add_grid(mesh, circle_segments, rings - 1, false);
  // The centre once a segment: its angle differs.
  const float inner = radius_of(0);
  for (int i = 0; i < circle_segments; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const float v = static_cast<float>(i) / circle_segments;
    const float next = static_cast<float>(i + 1) / circle_segments;
    add_vertex(mesh, Vec3(0.0f), up, 0.0f, 0.5f * (v + next));
    add_vertex(mesh, Vec3(inner * on_circle(i, circle_segments), 0.0f), up, inner, v);
    add_vertex(mesh, Vec3(inner * on_circle(i + 1, circle_segments), 0.0f), up, inner, next);
    mesh.triangles.push_back({{first, first + 1, first + 2}});
  }
  return mesh;
}

Mesh tessellate_cylinder() {
  Mesh mesh;
  for (int j = 0; j <= 1; ++j) {
    for (int i = 0; i <= circle_segments; ++i) {
      const Vec3 normal(on_circle(i, circle_segments), 0.0f);
      const auto z = static_cast<float>(j);
      add_vertex(mesh, normal + Vec3(0, 0, z), normal, static_cast<float>(i) / circle_segments, z);
    }
  }
  add_grid(mesh, circle_segments, 1, false);
  // The rows of vertices go up here, not down: the grid's triangles face inward.
  for (TriangleIndices& t : mesh.triangles) std::swap(t.v[1], t.v[2]);
  return mesh;
}

Mesh tessellate_rectangle() {
  Mesh mesh;
  add_face(mesh, rectangle_face());
  return mesh;
}

Mesh tessellate_cube() {
  Mesh mesh;
  for (const BoxFace& face : cube_faces()) add_face(mesh, face);
  return mesh;
}

}  // namespace pt::mitsuba
