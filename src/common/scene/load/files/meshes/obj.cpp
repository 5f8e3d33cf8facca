#include <algorithm>
#include <iterator>

#include "common/error/error_context.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/files/meshes/mesh_finish.h"
#include "common/scene/load/files/meshes/obj_parser.h"
#include "common/scene/load/files/whole_file.h"

namespace pt {
namespace {

/// All faces in one mesh.
class OneMesh : public ObjSink {
 public:
  void add_face(const std::vector<ObjCorner>& corners, const ObjVertices& vertices) override {
    builder.add_face(corners, vertices);
  }

  ObjMeshBuilder builder;
};

Mesh decode(std::string_view bytes, const MeshFileOptions& options) {
  OneMesh sink;
  CountedWarnings warnings;
  parse_obj(bytes, sink, warnings);
  if (options.warnings) std::ranges::copy(warnings.lines(), std::back_inserter(*options.warnings));
  Mesh mesh = std::move(sink.builder).finish(options.warnings);
  finish_mesh(mesh, options, options.warnings);
  return mesh;
}

}  // namespace

Mesh decode_obj(std::string_view bytes, const std::string& name, const MeshFileOptions& options) {
  return explaining("cannot read " + name, [&] { return decode(bytes, options); });
}

Mesh read_obj(const std::filesystem::path& path, const MeshFileOptions& options) {
  return explaining("cannot read " + path.string(),
                    [&] { return decode(WholeFile(path).bytes(), options); });
}

}  // namespace pt
