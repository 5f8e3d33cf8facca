// A triangle mesh in host memory, as loaders and generators make it, and its instances; what
// shading needs of a triangle.
#pragma once

#include <vector>

#include "common/math/transform.h"
#include "common/math/vec.h"

namespace pt {

/// The three vertices of a triangle.
struct TriangleIndices {
  std::uint32_t v[3];
};

/// Counterclockwise triangles point to the viewer: the geometric normal is
/// cross(p1 - p0, p2 - p0).
struct Mesh {
  std::vector<Vec3> positions;
  std::vector<TriangleIndices> triangles;
  std::vector<Vec3> normals;  ///< by vertex, unit length, or empty: flat triangles
  std::vector<Vec2> uvs;  ///< texture coordinates by vertex, or empty; v = 0 is the image's foot
  std::uint32_t material = 0;
  std::uint32_t group = 0;  ///< 0: part of the world; else what instances of this group repeat
  bool masked = false;      ///< set from the material: see TriangleAttributes
  /// Linear, by vertex and by triangle, or empty: what loaders make a texture of (vertex_colors.h).
  std::vector<Color> colors = {}, face_colors = {};
  /// Of a mesh that deforms: more sets of positions, and as many of normals or none, at equally
  /// spaced times until the shutter closes. Between, all are linear in time. Empty: they stay.
  std::vector<std::vector<Vec3>> later_positions = {}, later_normals = {};

  std::size_t vertex_sets() const { return 1 + later_positions.size(); }
  const std::vector<Vec3>& positions_of(std::size_t set) const {
    return set == 0 ? positions : later_positions[set - 1];
  }
  const std::vector<Vec3>& normals_of(std::size_t set) const {
    return set == 0 || later_normals.empty() ? normals : later_normals[set - 1];
  }
  void stop_deforming() { later_positions.clear(), later_normals.clear(); }
};

/// The mesh as it is at one of its sets of vertices.
inline Mesh mesh_at(const Mesh& mesh, std::size_t set) {
  return {mesh.positions_of(set), mesh.triangles, mesh.normals_of(set), mesh.uvs,
          mesh.material,          mesh.group,     mesh.masked,          mesh.colors,
          mesh.face_colors};
}

/// The attributes of a triangle's corners, side by side: four 16-byte loads from two sectors of
/// memory. Vertices that triangles share are repeated. Their own arrays would be half as large, but
/// a hit would read 15 words from seven addresses, and their indices before that.
struct alignas(64) CornerAttributes {
  Vec3 normal[3] = {Vec3(0.0f), Vec3(0.0f), Vec3(0.0f)};  ///< unit length, or the mesh has none
  Vec2 uv[3] = {Vec2(0.0f), Vec2(0.0f), Vec2(0.0f)};
  float padding = 0.0f;

  PT_HD Vec3 normal_at(const Vec3& b) const {
    return weighted_sum(b, normal[0], normal[1], normal[2]);
  }
  PT_HD Vec2 uv_at(const Vec3& b) const {
    const Vec3 at = weighted_sum(b, Vec3(uv[0], 0.0f), Vec3(uv[1], 0.0f), Vec3(uv[2], 0.0f));
    return {at.x, at.y};
  }
};
static_assert(sizeof(CornerAttributes) == 64);

/// A group of meshes placed in the world.
struct Instance {
  std::uint32_t group = 0;  ///< Mesh::group, not 0
  Affine to_world;
};

}  // namespace pt
