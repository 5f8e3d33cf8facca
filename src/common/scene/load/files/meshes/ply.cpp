#include <fmt/format.h>

#include <algorithm>

#include "common/error/error_context.h"
#include "common/error/quoted.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/files/meshes/mesh_finish.h"
#include "common/scene/load/files/meshes/ply_elements.h"
#include "common/scene/load/files/meshes/text_number.h"
#include "common/scene/load/files/whole_file.h"

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

std::string names_of(const PlyHeader& header) {
  std::string names;
  for (const PlyElement& element : header.elements) {
    names += fmt::format("{}{} {}", names.empty() ? "" : ", ", element.count, element.name);
    if (names.size() > 200) break;
  }
  return clipped(names, 200);
}

template <class Values>
void read_body(Values& values, const PlyHeader& header, PlyMesh& out) {
  const PlyElement* vertices = header.find("vertex");
  const PlyElement *faces = header.find("face"), *strips = header.find("tristrips");
  if (!vertices || (!faces && !strips)) {
    throw Error(fmt::format("expected elements 'vertex' and 'face' or 'tristrips', found {}{}",
                            header.elements.empty() ? "none" : names_of(header),
                            vertices ? ": points without faces are not supported" : ""));
  }
  const PlyElement* last = std::max({vertices, faces, strips});  // what follows is not ours
  for (const PlyElement& element : header.elements) {
    if (&element == vertices) {
      read_ply_vertices(values, element, out);
    } else if (&element == faces) {
      read_ply_faces(values, element, vertices->count, out);
    } else if (&element == strips) {
      read_ply_strips(values, element, vertices->count, out);
    } else {
      skip_element(values, element, header.encoding == PlyEncoding::ascii);
    }
    if (&element == last) break;
  }
}

void read_text(std::string_view body, const PlyHeader& header, PlyMesh& out) {
  PlyTextValues values(body);
  try {
    read_body(values, header, out);
  } catch (const Error& error) {
    const std::string_view done = body.substr(0, body.size() - values.rest().size());
    throw Error(fmt::format("line {}: {}", header.lines + 1 + std::ranges::count(done, '\n'),
                            error.what()));
  }
}

/// A few bad faces are left out. Where they are the most the file is taken for damaged.
void report_lost(PlyMesh& out) {
  if (out.lost == 0) return;
  if (out.lost > out.mesh.triangles.size()) throw Error(out.first_lost);
  out.warnings.push_back(
      fmt::format("{} bad faces are left out, the first is {}", out.lost, out.first_lost));
}

Mesh decode_file(std::string_view file, const MeshFileOptions& options) {
  const std::string_view bytes = without_byte_order_mark(file);
  const PlyHeader header = read_ply_header(bytes);
  const std::string_view body = bytes.substr(header.bytes);
  PlyMesh read;
  if (header.names_texture) read.warnings.emplace_back("the picture that it names is ignored");
  if (header.encoding == PlyEncoding::ascii) {
    read_text(body, header, read);
  } else {
    PlyBinaryValues values(body, header.encoding == PlyEncoding::big_endian);
    read_body(values, header, read);
  }
  report_lost(read);
  if (!read.mesh.face_colors.empty()) {  // strips have none
    read.mesh.face_colors.resize(read.mesh.triangles.size(), Color(1.0f));
  }
  read.fans.cut_concave(read.mesh, &read.warnings);
  finish_mesh(read.mesh, options, &read.warnings);
  if (options.warnings) {
    options.warnings->insert(options.warnings->end(), read.warnings.begin(), read.warnings.end());
  }
  return std::move(read.mesh);
}

}  // namespace

Mesh decode_ply(std::string_view bytes, const std::string& name, const MeshFileOptions& options) {
  return explaining("cannot read " + name, [&] { return decode_file(bytes, options); });
}

Mesh read_ply(const std::filesystem::path& path, const MeshFileOptions& options) {
  return explaining("cannot read " + path.string(),
                    [&] { return decode_file(WholeFile(path).bytes(), options); });
}

}  // namespace pt
