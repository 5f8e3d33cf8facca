// The vertices and faces of a PLY file.
#pragma once

#include <string>
#include <vector>

#include "common/geometry/mesh.h"
#include "common/scene/load/files/meshes/ply_header.h"
#include "common/scene/load/files/meshes/ply_values.h"
#include "common/scene/load/files/meshes/polygons.h"

namespace pt {

/// What a file has given so far.
struct PlyMesh {
  Mesh mesh;
  PolygonFans fans;
  std::uint64_t lost = 0;       ///< faces that are left out
  std::string first_lost = {};  ///< the first of them and what is wrong with it
  std::vector<std::string> warnings = {};
};

/// All read the elements that follow in `values`; normals and uvs stay empty where the file has
/// none. Throw Error naming the vertex or face.
void read_ply_vertices(PlyBinaryValues& values, const PlyElement& element, PlyMesh& out);
void read_ply_vertices(PlyTextValues& values, const PlyElement& element, PlyMesh& out);

/// `vertex_count` is the number of vertices, read or still to come.
void read_ply_faces(PlyBinaryValues& values, const PlyElement& element, std::uint64_t vertex_count,
                    PlyMesh& out);
void read_ply_faces(PlyTextValues& values, const PlyElement& element, std::uint64_t vertex_count,
                    PlyMesh& out);

/// Strips of triangles, as scanners' programs write them: every second one is turned over, -1
/// begins another strip.
void read_ply_strips(PlyBinaryValues& values, const PlyElement& element, std::uint64_t vertex_count,
                     PlyMesh& out);
void read_ply_strips(PlyTextValues& values, const PlyElement& element, std::uint64_t vertex_count,
                     PlyMesh& out);

/// Throws Error where `element` announces more than the rest of a file can hold.
void check_ply_count(const PlyElement& element, std::size_t rest_bytes, bool ascii);

/// Reads one list's count. Throws Error for one that is negative.
template <class Values>
std::uint64_t next_ply_count(Values& values, PlyType type) {
  const double count = values.next(type);
  if (!(count >= 0 && count < 0x1p32)) throw Error("a list with a negative or huge count");
  return static_cast<std::uint64_t>(count);
}

/// Makes linear colours of the numbers of a file. Floats are linear. Integers are in the sRGB
/// curve; 1 is the largest number of 8 bits where none is larger, else that of 16 bits, else that
/// of the type. What is negative or not finite becomes 0.
void decode_ply_colors(std::vector<Color>& colors, PlyType type);

/// Passes over a property.
template <class Values>
void skip_ply_property(Values& values, const PlyProperty& property) {
  std::uint64_t count = property.count_type ? next_ply_count(values, *property.count_type) : 1;
  for (; count > 0; --count) values.next(property.type);
}

}  // namespace pt
