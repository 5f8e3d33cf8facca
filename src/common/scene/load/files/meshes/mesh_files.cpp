#include "common/scene/load/files/meshes/mesh_files.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <any>
#include <cmath>
#include <iterator>
#include <utility>

#include "common/error/error.h"
#include "common/geometry/bounds.h"
#include "common/scene/load/files/read_ahead.h"

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

/// Leaves out the triangles that are bad. `what`, with the first of them, is an Error where they
/// are more than the others: then the file is damaged.
template <class Predicate>
void drop_triangles(Mesh& mesh, Predicate bad, const std::string& what,
                    std::vector<std::string>* warnings) {
  std::size_t kept = 0;
  const std::size_t before = mesh.triangles.size();
  for (std::size_t i = 0; i < before; ++i) {
    if (bad(mesh.triangles[i])) continue;
    if (!mesh.face_colors.empty()) mesh.face_colors[kept] = mesh.face_colors[i];
    mesh.triangles[kept++] = mesh.triangles[i];
  }
  if (before - kept > kept) throw Error(what);
  mesh.triangles.resize(kept);
  if (!mesh.face_colors.empty()) mesh.face_colors.resize(kept);
  if (kept < before && warnings) {
    warnings->push_back(
        fmt::format("{} bad triangles are left out, the first because of {}", before - kept, what));
  }
}

void drop_bad_positions(Mesh& mesh, std::vector<std::string>* warnings) {
  std::vector<Vec3>& positions = mesh.positions;
  const std::size_t bad =
      first_bad(positions.size(), [&](std::size_t i) { return !is_finite(positions[i]); });
  if (bad == positions.size()) return;
  const auto is_bad = [&](const TriangleIndices& triangle) {
    return std::ranges::any_of(triangle.v,
                               [&](std::uint32_t v) { return !is_finite(positions[v]); });
  };
  drop_triangles(mesh, is_bad,
                 fmt::format("vertex {}: position ({}, {}, {}), expected finite numbers", bad,
                             positions[bad].x, positions[bad].y, positions[bad].z),
                 warnings);
  for (Vec3& p : positions) p = is_finite(p) ? p : Vec3(0.0f);  // nothing uses them
}

void drop_bad_indices(Mesh& mesh, std::vector<std::string>* warnings) {
  const std::size_t count = mesh.positions.size();
  const auto is_bad = [&](const TriangleIndices& triangle) {
    return std::max({triangle.v[0], triangle.v[1], triangle.v[2]}) >= count;
  };
  const std::size_t bad =
      first_bad(mesh.triangles.size(), [&](std::size_t i) { return is_bad(mesh.triangles[i]); });
  if (bad == mesh.triangles.size()) return;
  const auto& v = mesh.triangles[bad].v;
  drop_triangles(mesh, is_bad,
                 fmt::format("triangle {}: indices {}, {} and {} into {} vertices", bad, v[0], v[1],
                             v[2], count),
                 warnings);
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

/// Gives each vertex whose normal is zero that of a triangle, or +z where none has one. Returns how
/// many got that of a triangle.
std::size_t replace_zero_normals(Mesh& mesh) {
  const Vec3 zero(0.0f);
  std::vector<Vec3>& normals = mesh.normals;
  std::size_t replaced = 0;
  for (const TriangleIndices& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle.v) {
      if (normals[v] != zero) continue;
      normals[v] = triangle_normal(mesh, triangle);
      if (normals[v] != zero) ++replaced;
    }
  }
  std::replace(normals.begin(), normals.end(), zero, Vec3(0, 0, 1));
  return replaced;
}

void finish_normals(Mesh& mesh, std::vector<std::string>* warnings) {
  std::vector<Vec3>& normals = mesh.normals;
  tbb::parallel_for(Range(0, normals.size(), grain), [&](const Range& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) normals[i] = direction_of(normals[i]);
  });
  const auto is_zero = [&](std::size_t i) { return normals[i] == Vec3(0.0f); };
  if (first_bad(normals.size(), is_zero) == normals.size()) return;
  const std::size_t replaced = replace_zero_normals(mesh);
  if (replaced > 0 && warnings) {
    warnings->push_back(
        fmt::format("{} of {} vertices have no normal or one without a direction: that of a "
                    "triangle is used",
                    replaced, normals.size()));
  }
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

struct ReadMesh {
  Mesh mesh;
  std::vector<std::string> warnings;
};

ReadMesh read(const MeshFile& file) {
  ReadMesh result;
  MeshFileOptions options = file.options;
  options.warnings = &result.warnings;
  switch (file.format) {
    case MeshFile::Format::obj:
      result.mesh = read_obj(file.path, options);
      break;
    case MeshFile::Format::ply:
      result.mesh = read_ply(file.path, options);
      break;
    case MeshFile::Format::serialized:
      result.mesh = read_serialized(file.path, file.shape_index, options);
      break;
  }
  return result;
}

std::string key_of(const MeshFile& file) {
  return fmt::format("mesh {} {} {} {} {}", static_cast<int>(file.format),
                     file.options.face_normals, file.options.flip_v, file.shape_index,
                     file.path.string());
}

}  // namespace

Mesh read_mesh(const MeshFile& file, std::vector<std::string>& warnings) {
  ReadMesh result = ReadAhead::take(key_of(file), [&] { return read(file); });
  std::ranges::move(result.warnings, std::back_inserter(warnings));
  return std::move(result.mesh);
}

void read_mesh_ahead(const MeshFile& file) {
  ReadAhead::announce(key_of(file), [file] { return std::any(read(file)); });
}

void finish_mesh(Mesh& mesh, const MeshFileOptions& options, std::vector<std::string>* warnings) {
  drop_bad_indices(mesh, warnings);
  drop_bad_positions(mesh, warnings);
  if (options.face_normals) mesh.normals = {};
  finish_normals(mesh, warnings);
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
  finish_normals(mesh, nullptr);
}

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
  for (std::vector<Vec3>& normals : mesh.later_normals)
    for (Vec3& normal : normals) normal = -normal;
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

namespace {

/// Moves vertices a little, along the normals of their triangles.
void set_off(std::vector<Vec3>& positions, const std::vector<TriangleIndices>& triangles) {
  Bounds bounds;
  for (const Vec3& p : positions) bounds.grow(p);
  const float extent = glm::length(bounds.max - bounds.min);
  const float reach = std::max(max_abs(bounds.min), max_abs(bounds.max));
  const float offset = std::max(1e-5f * extent, 4e-6f * reach);
  std::vector<Vec3> normals(positions.size(), Vec3(0.0f));
  for (const TriangleIndices& t : triangles) {
    const Vec3& p = positions[t.v[0]];
    const Vec3 n = glm::cross(positions[t.v[1]] - p, positions[t.v[2]] - p);
    for (const std::uint32_t v : t.v) normals[v] += n;
  }
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const float length = glm::length(normals[i]);
    if (length > 0.0f) positions[i] += (offset / length) * normals[i];
  }
}

}  // namespace

Mesh back_of(const Mesh& mesh) {
  Mesh back = mesh;
  turn_mesh(back);
  set_off(back.positions, back.triangles);
  for (std::vector<Vec3>& positions : back.later_positions) set_off(positions, back.triangles);
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
