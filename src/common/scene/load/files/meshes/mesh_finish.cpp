#include "common/scene/load/files/meshes/mesh_finish.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

#include "common/error/error.h"

namespace pt {
namespace {

using Range = tbb::blocked_range<std::size_t>;
constexpr std::size_t grain = 1 << 14;

/// The first i in [0, count) with bad(i), or count.
template <class Predicate>
std::size_t first_bad(std::size_t count, Predicate bad) {
  return tbb::parallel_reduce(
      Range(0, count, grain), count,
      [&](const Range& range, std::size_t found) {
        for (std::size_t i = range.begin(); i < std::min(range.end(), found); ++i) {
          if (bad(i)) return i;
        }
        return found;
      },
      [](std::size_t a, std::size_t b) { return std::min(a, b); });
}

bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void check_positions(const Mesh& mesh) {
  const std::vector<Vec3>& positions = mesh.positions;
  const std::size_t bad =
      first_bad(positions.size(), [&](std::size_t i) { return !is_finite(positions[i]); });
  if (bad == positions.size()) return;
  throw Error(fmt::format("vertex {}: position ({}, {}, {}), expected finite numbers", bad,
                          positions[bad].x, positions[bad].y, positions[bad].z));
}

void check_indices(const Mesh& mesh) {
  const std::size_t count = mesh.positions.size();
  const std::size_t bad = first_bad(mesh.triangles.size(), [&](std::size_t i) {
    const auto& v = mesh.triangles[i].v;
    return std::max({v[0], v[1], v[2]}) >= count;
  });
  if (bad == mesh.triangles.size()) return;
  const auto& v = mesh.triangles[bad].v;
  throw Error(fmt::format("triangle {}: indices {}, {} and {} into {} vertices", bad, v[0], v[1],
                          v[2], count));
}

/// v / |v| without overflow, or zero where v has no direction.
Vec3 direction_of(const Vec3& v) {
  const float largest = max_abs(v);
  if (!is_finite(v) || largest == 0.0f) return Vec3(0.0f);
  const Vec3 scaled = v / largest;  // exact enough: its length is in [1, sqrt(3)]
  return is_finite(scaled) ? scaled / glm::length(scaled) : Vec3(0.0f);
}

Vec3 triangle_normal(const Mesh& mesh, const TriangleIndices& triangle) {
  const Vec3& p0 = mesh.positions[triangle.v[0]];
  return direction_of(
      glm::cross(mesh.positions[triangle.v[1]] - p0, mesh.positions[triangle.v[2]] - p0));
}

/// Gives each vertex whose normal is zero that of a triangle, or +z where none has one.
void replace_zero_normals(Mesh& mesh) {
  const Vec3 zero(0.0f);
  std::vector<Vec3>& normals = mesh.normals;
  for (const TriangleIndices& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle.v) {
      if (normals[v] == zero) normals[v] = triangle_normal(mesh, triangle);
    }
  }
  std::replace(normals.begin(), normals.end(), zero, Vec3(0, 0, 1));
}

void finish_normals(Mesh& mesh) {
  std::vector<Vec3>& normals = mesh.normals;
  tbb::parallel_for(Range(0, normals.size(), grain), [&](const Range& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) normals[i] = direction_of(normals[i]);
  });
  const auto is_zero = [&](std::size_t i) { return normals[i] == Vec3(0.0f); };
  if (first_bad(normals.size(), is_zero) < normals.size()) replace_zero_normals(mesh);
}

void finish_uvs(Mesh& mesh, bool flip_v) {
  tbb::parallel_for(Range(0, mesh.uvs.size(), grain), [&](const Range& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      Vec2& uv = mesh.uvs[i];
      if (!std::isfinite(uv.x)) uv.x = 0.0f;
      if (!std::isfinite(uv.y)) uv.y = 0.0f;
      if (flip_v) uv.y = 1.0f - uv.y;
    }
  });
}

/// The angle between two edges; 0 where one has no length.
float angle_between(const Vec3& a, const Vec3& b) {
  // Kahan's formula: exact for small angles, where acos of the cosine is not.
  const Vec3 u = direction_of(a), v = direction_of(b);
  return 2.0f * std::atan2(glm::length(u - v), glm::length(u + v));
}

}  // namespace

void finish_mesh(Mesh& mesh, const MeshFileOptions& options) {
  check_positions(mesh);
  check_indices(mesh);
  if (options.face_normals) mesh.normals = {};
  finish_normals(mesh);
  finish_uvs(mesh, options.flip_v);
}

void compute_vertex_normals(Mesh& mesh) {
  mesh.normals.assign(mesh.positions.size(), Vec3(0.0f));
  for (const TriangleIndices& triangle : mesh.triangles) {
    const Vec3 normal = triangle_normal(mesh, triangle);
    for (int i = 0; i < 3; ++i) {
      const Vec3& p = mesh.positions[triangle.v[i]];
      const Vec3 a = mesh.positions[triangle.v[(i + 1) % 3]] - p;
      const Vec3 b = mesh.positions[triangle.v[(i + 2) % 3]] - p;
      mesh.normals[triangle.v[i]] += angle_between(a, b) * normal;
    }
  }
  finish_normals(mesh);
}

}  // namespace pt
