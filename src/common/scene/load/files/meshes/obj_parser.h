// The lines of an OBJ file. One that is wrong loses itself, or what needs it, and not the file.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/scene/load/files/counted_warnings.h"
#include "common/scene/load/files/meshes/obj_builder.h"

namespace pt {

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
