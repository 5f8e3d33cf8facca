// What shading asks of a triangle beyond its corners.
#pragma once

#include "common/geometry/mesh.h"

namespace pt {

/// The vertices' attributes of all meshes, one after the other: a view. Empty where no mesh has
/// any.
struct VertexAttributes {
  const TriangleIndices* triangles = nullptr;  ///< [triangle id]
  const Vec3* normals = nullptr;               ///< [vertex]
  const Vec2* uvs = nullptr;                   ///< [vertex]

  PT_HD Vec3 normal(std::uint32_t id, const Vec3& b) const {
    const TriangleIndices t = triangles[id];
    return b.x * normals[t.v[0]] + b.y * normals[t.v[1]] + b.z * normals[t.v[2]];
  }
  PT_HD Vec2 uv(std::uint32_t id, const Vec3& b) const {
    const TriangleIndices t = triangles[id];
    return b.x * uvs[t.v[0]] + b.y * uvs[t.v[1]] + b.z * uvs[t.v[2]];
  }
};

}  // namespace pt
