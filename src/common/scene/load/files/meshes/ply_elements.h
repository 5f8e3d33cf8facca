// The vertices and faces of a PLY file.
#pragma once

#include "common/geometry/mesh.h"
#include "common/scene/load/files/meshes/ply_header.h"
#include "common/scene/load/files/meshes/ply_values.h"

namespace pt {

/// Both read the elements that follow in `values` into the mesh; normals and uvs stay empty where
/// the file has none. Throw Error naming the vertex or face.
void read_ply_vertices(PlyBinaryValues& values, const PlyElement& element, Mesh& mesh);
void read_ply_vertices(PlyTextValues& values, const PlyElement& element, Mesh& mesh);

/// `vertex_count` is the number of vertices, read or still to come.
void read_ply_faces(PlyBinaryValues& values, const PlyElement& element, std::uint64_t vertex_count,
                    Mesh& mesh);
void read_ply_faces(PlyTextValues& values, const PlyElement& element, std::uint64_t vertex_count,
                    Mesh& mesh);

/// Throws Error where `element` announces more than the rest of a file can hold.
void check_ply_count(const PlyElement& element, std::size_t rest_bytes, bool ascii);

/// Reads one list's count. Throws Error for one that is negative.
template <class Values>
std::uint64_t next_ply_count(Values& values, PlyType type) {
  const double count = values.next(type);
  if (!(count >= 0 && count < 0x1p32)) throw Error("a list with a negative or huge count");
  return static_cast<std::uint64_t>(count);
}

/// The linear colour of three numbers of a file: integers are in the sRGB curve, the type's largest
/// is 1; floats are linear. What is negative or not finite becomes 0.
Color decode_ply_color(const Color& numbers, PlyType type);

/// Passes over a property.
template <class Values>
void skip_ply_property(Values& values, const PlyProperty& property) {
  std::uint64_t count = property.count_type ? next_ply_count(values, *property.count_type) : 1;
  for (; count > 0; --count) values.next(property.type);
}

}  // namespace pt
