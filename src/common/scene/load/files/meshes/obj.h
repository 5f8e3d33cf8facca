// The lines of an OBJ file, and meshes out of them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/mesh.h"
#include "common/scene/load/files/meshes/polygons.h"
#include "common/scene/load/files/text.h"

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
  std::uint32_t vertex_of(const ObjCorner& corner, const ObjVertices& vertices);
  /// The slot that has the corner's vertex, or the empty one where it belongs.
  std::uint32_t& slot_of(const ObjCorner& corner);
  void double_slots();

  Mesh mesh_;
  PolygonFans fans_;
  bool has_uvs_ = false, has_normals_ = false;
  std::vector<ObjCorner> corners_;    ///< by vertex
  std::vector<std::uint32_t> slots_;  ///< vertices by the hash of their corners, or obj_none; 2^n
};

// The lines of an OBJ file. One that is wrong loses itself, or what needs it, and not the file.

/// What a parser hands its faces and materials to.
class ObjSink {
 public:
  virtual ~ObjSink() = default;
  virtual void add_face(const std::vector<ObjCorner>& corners, const ObjVertices& vertices) = 0;
  virtual void use_material(std::string_view /*name*/, std::size_t /*line_number*/) {}
  virtual void read_library(std::string_view /*names*/) {}  ///< of MTL files: the line's rest
};

/// Reads all lines: vertices, faces, materials; others (groups, lines, curves) mean nothing here.
/// `warnings` are told of what is left out, and of its line: a face with fewer than three vertices,
/// or with one that is not there or not finite; a texture coordinate or normal that is not there.
void parse_obj(std::string_view file, ObjSink& sink, CountedWarnings& warnings);

}  // namespace pt
