#include "common/accel/build/mesh_triangles.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>

#include "common/accel/build/binary_tree.h"
#include "common/error.h"

namespace pt {

namespace {

constexpr float coordinate_max = 1e12f;  // area times distance is still a float

bool is_in_range(const Vec3& p) { return max_abs(p) <= coordinate_max && p == p; }

bool is_valid(const Mesh& mesh, std::size_t triangle) {
  return std::all_of(
      std::begin(mesh.triangles[triangle].v), std::end(mesh.triangles[triangle].v),
      [&](std::uint32_t v) { return v < mesh.positions.size() && is_in_range(mesh.positions[v]); });
}

std::size_t first_invalid(const Mesh& mesh) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, mesh.triangles.size(), 1 << 14), mesh.triangles.size(),
      [&](const auto& part, std::size_t first) {
        for (std::size_t i = part.begin(); i < part.end() && i < first; ++i) {
          if (!is_valid(mesh, i)) return i;
        }
        return first;
      },
      [](std::size_t a, std::size_t b) { return std::min(a, b); });
}

[[noreturn]] void throw_invalid(const Mesh& mesh, std::size_t mesh_index, std::size_t triangle) {
  for (const std::uint32_t v : mesh.triangles[triangle].v) {
    if (v >= mesh.positions.size()) {
      throw Error(fmt::format("mesh {}, triangle {}: vertex {}, expected less than {}", mesh_index,
                              triangle, v, mesh.positions.size()));
    }
    const Vec3 p = mesh.positions[v];
    if (!is_in_range(p)) {
      throw Error(fmt::format(
          "mesh {}, triangle {}: vertex {} at ({}, {}, {}), expected finite coordinates within "
          "{:g}",
          mesh_index, triangle, v, p.x, p.y, p.z, coordinate_max));
    }
  }
  throw Error(fmt::format("mesh {}, triangle {}: invalid", mesh_index, triangle));
}

}  // namespace

MeshTriangles::MeshTriangles(std::span<const Mesh> meshes, std::optional<std::uint32_t> group)
    : meshes_(meshes) {
  std::uint64_t id = 0, count = 0;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    if (!group || meshes[m].group == *group) {
      mesh_.push_back(static_cast<std::uint32_t>(m));
      first_id_.push_back(static_cast<std::uint32_t>(id));
      first_.push_back(static_cast<std::uint32_t>(count));
      count += meshes[m].triangles.size();
    }
    id += meshes[m].triangles.size();
    if (id > build_primitives_max) {
      throw Error(fmt::format("meshes: more than {} triangles, expected at most as many",
                              build_primitives_max));
    }
  }
  first_.push_back(static_cast<std::uint32_t>(count));
}

std::size_t MeshTriangles::part_of(std::uint32_t i) const {
  return static_cast<std::size_t>(std::upper_bound(first_.begin(), first_.end(), i) -
                                  first_.begin()) -
         1;
}

Triangle MeshTriangles::operator[](std::uint32_t i) const {
  const std::size_t part = part_of(i);
  const Mesh& mesh = meshes_[mesh_[part]];
  const std::uint32_t local = i - first_[part];
  const std::uint32_t(&v)[3] = mesh.triangles[local].v;
  return {mesh.positions[v[0]], first_id_[part] + local, mesh.positions[v[1]],
          mesh.material,        mesh.positions[v[2]],    triangle_attributes(mesh)};
}

Bounds MeshTriangles::bounds(std::uint32_t i) const {
  const Triangle t = (*this)[i];
  return hit_bounds(t.v0, t.v1, t.v2);
}

void MeshTriangles::check() const {
  for (const std::uint32_t m : mesh_) {
    const std::size_t invalid = first_invalid(meshes_[m]);
    if (invalid < meshes_[m].triangles.size()) throw_invalid(meshes_[m], m, invalid);
  }
}

}  // namespace pt
