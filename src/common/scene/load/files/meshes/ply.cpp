#include <fmt/format.h>

#include <algorithm>

#include "common/error/error_context.h"
#include "common/scene/load/files/mapped_file.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/files/meshes/mesh_finish.h"
#include "common/scene/load/files/meshes/ply_elements.h"
#include "common/scene/load/files/meshes/text_number.h"

namespace pt {
namespace {

/// Passes over elements that mean nothing to us, such as edges.
template <class Values>
void skip_element(Values& values, const PlyElement& element, bool ascii) {
  if (element.properties.empty()) return;
  check_ply_count(element, values.rest().size(), ascii);
  for (std::uint64_t i = 0; i < element.count; ++i) {
    for (const PlyProperty& property : element.properties) skip_ply_property(values, property);
  }
}

template <class Values>
Mesh read_body(Values& values, const PlyHeader& header) {
  const PlyElement* vertices = header.find("vertex");
  const PlyElement* faces = header.find("face");
  if (!vertices || !faces) throw Error("expected elements 'vertex' and 'face'");
  Mesh mesh;
  for (const PlyElement& element : header.elements) {
    if (&element == vertices) {
      read_ply_vertices(values, element, mesh);
    } else if (&element == faces) {
      read_ply_faces(values, element, vertices->count, mesh);
      if (faces > vertices) break;  // what follows is not ours
    } else {
      skip_element(values, element, header.encoding == PlyEncoding::ascii);
    }
  }
  return mesh;
}

Mesh read_text(std::string_view body, const PlyHeader& header) {
  PlyTextValues values(body);
  try {
    return read_body(values, header);
  } catch (const Error& error) {
    const std::string_view done = body.substr(0, body.size() - values.rest().size());
    throw Error(fmt::format("line {}: {}", header.lines + 1 + std::ranges::count(done, '\n'),
                            error.what()));
  }
}

Mesh decode_file(std::string_view file, const MeshFileOptions& options) {
  const std::string_view bytes = without_byte_order_mark(file);
  const PlyHeader header = read_ply_header(bytes);
  const std::string_view body = bytes.substr(header.bytes);
  Mesh mesh;
  if (header.encoding == PlyEncoding::ascii) {
    mesh = read_text(body, header);
  } else {
    PlyBinaryValues values(body, header.encoding == PlyEncoding::big_endian);
    mesh = read_body(values, header);
  }
  finish_mesh(mesh, options);
  return mesh;
}

}  // namespace

Mesh decode_ply(std::string_view bytes, const std::string& name, const MeshFileOptions& options) {
  return explaining("cannot read " + name, [&] { return decode_file(bytes, options); });
}

Mesh read_ply(const std::filesystem::path& path, const MeshFileOptions& options) {
  return explaining("cannot read " + path.string(),
                    [&] { return decode_file(MappedFile(path).bytes(), options); });
}

}  // namespace pt
