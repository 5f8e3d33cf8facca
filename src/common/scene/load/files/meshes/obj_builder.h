// A mesh out of the vertices of an OBJ file, whose corners name position, texture coordinate and
// normal apart.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "common/geometry/mesh.h"
#include "common/scene/load/files/meshes/polygons.h"

namespace pt {

/// Positions, texture coordinates and normals that a file has listed so far.
struct ObjVertices {
  std::vector<Vec3> positions;
  std::vector<Color> colors;  ///< linear, of the first positions; the others have none
  std::vector<Vec2> uvs;
  std::vector<Vec3> normals;
};

inline constexpr std::uint32_t obj_none = 0xffffffffu;

/// A corner of a face: numbers in ObjVertices, `uv` and `normal` may be obj_none.
struct ObjCorner {
  std::uint32_t position, uv, normal;
  bool operator==(const ObjCorner&) const = default;
};

class ObjMeshBuilder {
 public:
  /// Adds a face of 3 or more corners.
  void add_face(const std::vector<ObjCorner>& corners, const ObjVertices& vertices);

  /// The mesh, one vertex for each different corner. Without uvs, normals or colours where no
  /// corner has one; else a corner without has the uv (0, 0), the normal 0, and is white.
  /// `warnings`: of faces that could not be cut into triangles; or null.
  Mesh finish(std::vector<std::string>* warnings) &&;

 private:
  struct Hash {
    std::size_t operator()(const ObjCorner& corner) const;
  };

  std::uint32_t vertex_of(const ObjCorner& corner, const ObjVertices& vertices);

  Mesh mesh_;
  PolygonFans fans_;
  bool has_uvs_ = false, has_normals_ = false;
  std::unordered_map<ObjCorner, std::uint32_t, Hash> vertex_of_;
};

}  // namespace pt
