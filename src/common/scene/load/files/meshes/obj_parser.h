// The lines of an OBJ file. Our own parser and not tinyobjloader's, which takes a malformed number
// for 0 and a line's number from nobody; the materials are tinyobjloader's.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/scene/load/files/meshes/obj_builder.h"

namespace pt {

/// What a parser hands its faces and materials to.
class ObjSink {
 public:
  virtual ~ObjSink() = default;
  virtual void add_face(const std::vector<ObjCorner>& corners, const ObjVertices& vertices) = 0;
  virtual void use_material(std::string_view /*name*/) {}
  virtual void read_library(std::string_view /*names*/) {}  ///< of MTL files: the line's rest
};

/// Reads all lines: vertices, faces, materials; others (groups, lines, curves) mean nothing here.
/// Throws Error naming the line.
void parse_obj(std::string_view file, ObjSink& sink);

}  // namespace pt
