// The triangles of meshes by number.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/geometry/mesh.h"
#include "common/geometry/triangle.h"

namespace pt {

/// Triangle::attributes of a mesh's triangles.
inline std::uint32_t triangle_attributes(const Mesh& mesh) {
  return (mesh.normals.empty() ? 0 : TriangleAttributes::normals) |
         (mesh.uvs.empty() ? 0 : TriangleAttributes::uvs) |
         (mesh.masked ? TriangleAttributes::masked : 0);
}

/// Numbers the triangles of all meshes, or of those of one group, in the order of the meshes. Keeps
/// the span.
class MeshTriangles {
 public:
  explicit MeshTriangles(std::span<const Mesh> meshes, std::optional<std::uint32_t> group = {});

  std::uint32_t count() const { return first_.back(); }
  /// Triangle `i` of these; its id counts through all meshes.
  Triangle operator[](std::uint32_t i) const;
  Bounds bounds(std::uint32_t i) const;
  /// Throws Error for a triangle that names no vertex, or one whose coordinates are not finite or
  /// beyond 1e12.
  void check() const;

 private:
  std::size_t part_of(std::uint32_t i) const;

  std::span<const Mesh> meshes_;
  std::vector<std::uint32_t> mesh_;      // by part: a mesh in use
  std::vector<std::uint32_t> first_id_;  // by part
  std::vector<std::uint32_t> first_;     // by part, and the total
};

}  // namespace pt
