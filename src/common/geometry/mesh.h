// A triangle mesh in host memory, as loaders and generators make it.
#pragma once

#include <vector>

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
};

}  // namespace pt
