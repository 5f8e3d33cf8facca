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
    return weighted_sum(b, normals[t.v[0]], normals[t.v[1]], normals[t.v[2]]);
  }
  PT_HD Vec2 uv(std::uint32_t id, const Vec3& b) const {
    const TriangleIndices t = triangles[id];
    const Vec2 p = uvs[t.v[0]], q = uvs[t.v[1]], r = uvs[t.v[2]];
    const Vec3 uv = weighted_sum(b, Vec3(p, 0.0f), Vec3(q, 0.0f), Vec3(r, 0.0f));
    return {uv.x, uv.y};
  }
};

}  // namespace pt
