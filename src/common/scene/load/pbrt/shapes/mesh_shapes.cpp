// Shapes of triangles and of bilinear patches.
#include <fmt/format.h>

#include "common/error/host_memory.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/pbrt/shapes/loop_subdivision.h"
#include "common/scene/load/pbrt/shapes/mesh_reading.h"
#include "common/scene/load/pbrt/syntax/source.h"

namespace pt::pbrt {
namespace {

void set_triangles(Mesh& mesh, const std::vector<int>& indices) {
  mesh.triangles.reserve(indices.size() / 3);
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const auto at = [&](std::size_t k) { return static_cast<std::uint32_t>(indices[i + k]); };
    mesh.triangles.push_back({{at(0), at(1), at(2)}});
  }
}

}  // namespace

Mesh read_triangle_mesh(Context& context, const Entity& entity, const ShapeMaterial&) {
  Mesh mesh = read_vertices(context, entity.parameters);
  set_triangles(mesh, read_indices(context, entity.parameters, 3, mesh.positions.size()));
  finish(entity, mesh);
  return mesh;
}

/// Faces of four vertices, which pbrt makes bilinear patches, are two triangles.
Mesh read_ply_mesh(Context& context, const Entity& entity, const ShapeMaterial&) {
  const Parameters& parameters = entity.parameters;
  const Parameter* filename = parameters.find("filename", {"string"});
  if (!filename) fail(parameters.place(), "plymesh has no 'string filename'");
  if (parameters.find("displacement")) {
    context.reporter.warn_once("displacement of plymesh", parameters.place(),
                               "'displacement' of plymesh is not supported and ignored");
  }
  parameters.ignore({"edgelength", "shadowalpha", "discarddegenerateUVs"});  // the latter of v3
  const auto path = context.resolve(filename->place, parameters.text("filename", ""));
  std::vector<std::string> warnings;
  MeshFileOptions options;
  options.warnings = &warnings;
  Mesh mesh;
  try {
    const bool compressed = path.extension() == ".gz";
    mesh = compressed ? decode_ply(read_source(path), path.string(), options)
                      : read_ply(path, options);
  } catch (const Error& error) {
    fail(filename->place, error.what());
  }
  for (const std::string& warning : warnings) {
    context.reporter.warn_once(warning, filename->place,
                               fmt::format("{}: {}", path.string(), warning));
  }
  mesh.colors.clear(), mesh.face_colors.clear();
  return mesh;
}

Mesh read_loop_mesh(Context& context, const Entity& entity, const ShapeMaterial&) {
  const Parameters& parameters = entity.parameters;
  Mesh cage;
  cage.positions = parameters.points("P");
  set_triangles(cage, read_indices(context, parameters, 3, cage.positions.size()));
  finish(entity, cage);
  parameters.ignore({"scheme"});
  const int levels = parameters.integer("levels", parameters.integer("nlevels", 3));  // of v3
  constexpr std::uint64_t most = 1u << 26;                                            // triangles
  if (levels < 0 || levels > 12 || (cage.triangles.size() << (2 * levels)) > most) {
    fail(parameters.place(), fmt::format("loopsubdiv: {} levels of {} triangles; expected 0 to 12 "
                                         "and at most {} triangles in the end",
                                         levels, cage.triangles.size(), most));
  }
  try {
    // Of each triangle in the end: its vertices, and where its edges are found.
    constexpr std::uint64_t bytes = 256;
    check_host_memory((cage.triangles.size() << (2 * levels)) * bytes, "loopsubdiv");
    return subdivide_loop(cage, levels);
  } catch (const Error& error) {
    fail(parameters.place(), error.what());
  }
}

}  // namespace pt::pbrt
