// Triangle meshes in files: PLY, Wavefront OBJ, Mitsuba's .serialized.
//
// All readers cut faces of more than three corners into triangles (polygons.h), scale normals to
// unit length (one that has no direction becomes that of a triangle at its vertex) and set no
// material and no group. Faces with fewer than three vertices, with an index out of range or with a
// position that is not finite are left out with a warning; where they are more than the others the
// file is damaged. A texture coordinate that is not finite becomes 0. Readers throw Error, one line
// with the file and the line or element, for a file that is missing, truncated or malformed, and
// for sizes that the file cannot hold.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/mesh.h"
#include "common/math/transform.h"

namespace pt {

struct MeshFileOptions {
  bool face_normals = false;  ///< ignore the file's normals: flat triangles
  /// Replace v by 1 - v. Files say v = 0 at the image's foot, as Mesh does; Mitsuba takes the v of
  /// its textures from the head, so its `ply` and `serialized` shapes need this (unless they say
  /// flip_tex_coords) and its `obj` shapes do not (unless they say not to flip).
  bool flip_v = false;
  std::vector<std::string>* warnings = nullptr;  ///< gets what was guessed, a line each; or null
};

/// PLY, which may be in gzip: ASCII or binary of either byte order, any properties in any order.
/// Vertices give x y z, optional nx ny nz (or normal_x ...), optional texture coordinates (u v, s
/// t, texture_u texture_v or texture_s texture_t) and colours (red green blue, r g b, diffuse_red
/// ..., or color_0 color_1 color_2 as Mitsuba writes them); faces and tristrips give vertex_indices
/// or vertex_index, and faces optional colours. Colours that are floats are linear. Those that are
/// integers are in the sRGB curve: 255 is white where none is larger, else 65535, else the largest
/// of their type. May return an empty mesh.
Mesh read_ply(const std::filesystem::path& path, const MeshFileOptions& options = {});

/// All faces of an OBJ file as one mesh, ignoring its materials. A line that is wrong is left out,
/// and what needs it, with a warning. May return an empty mesh.
Mesh read_obj(const std::filesystem::path& path, const MeshFileOptions& options = {});

/// Shape number `shape_index` (0 is the first) of Mitsuba's .serialized, version 3 or 4. Flags that
/// do not say how precise its numbers are get a warning: they are floats.
Mesh read_serialized(const std::filesystem::path& path, int shape_index,
                     const MeshFileOptions& options = {});

/// A file of one mesh, and how to read it.
struct MeshFile {
  enum class Format { obj, ply, serialized };

  Format format;
  std::filesystem::path path;
  MeshFileOptions options{};  ///< but for the warnings
  int shape_index = 0;        ///< of serialized files
};

/// What read_obj(), read_ply() or read_serialized() returns or throws. `warnings` gets its lines.
Mesh read_mesh(const MeshFile& file, std::vector<std::string>& warnings);
/// Announces one call of read_mesh() (read_ahead.h).
void read_mesh_ahead(const MeshFile& file);

// The same of a file's content in memory, for which `name` stands in errors.

Mesh decode_ply(std::string_view bytes, const std::string& name,
                const MeshFileOptions& options = {});
Mesh decode_obj(std::string_view bytes, const std::string& name,
                const MeshFileOptions& options = {});
Mesh decode_serialized(std::string_view bytes, const std::string& name, int shape_index,
                       const MeshFileOptions& options = {});

/// Normals by vertex, the mean of the triangles' weighted by their angles (Thuermer and Wuethrich
/// 1998): what Mitsuba gives meshes that have none and do not ask for face_normals.
void compute_vertex_normals(Mesh& mesh);

// What every reader of meshes does at its end.

/// Makes a mesh as mesh_files.h promises of what a file said: leaves out the triangles with an
/// index that is out of range or a position that is not finite; drops normals where the options say
/// so, scales the others to unit length, flips v. Normals and uvs have the size of the positions or
/// none. Throws Error naming the first triangle (from 0) or vertex that is bad where most are.
/// `warnings`: or null.
void finish_mesh(Mesh& mesh, const MeshFileOptions& options,
                 std::vector<std::string>* warnings = nullptr);

// Meshes into other spaces, and inside out.

/// Positions and normals; the winding stays as it is.
void transform_mesh(Mesh& mesh, const Affine& map);

/// Turns normals and winding.
void turn_mesh(Mesh& mesh);

/// Winds each triangle so that its geometric normal is on the side of its vertices' normals.
void wind_by_normals(Mesh& mesh);

/// The other side of a lamp that shines on both: a surface of its own, a little behind the first.
Mesh back_of(const Mesh& mesh);

/// The scale of a map that keeps angles, or none.
std::optional<float> uniform_scale(const Affine& map);

}  // namespace pt
