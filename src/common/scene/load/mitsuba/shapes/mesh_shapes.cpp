// Shapes of triangles: obj, ply, serialized.
#include <fmt/format.h>

#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/mitsuba/shapes/place_mesh.h"
#include "common/scene/load/mitsuba/shapes/shape_kinds.h"

namespace pt::mitsuba {

void add_mesh(Context& context, const Object& shape, const Target& target, Mesh mesh,
              const Affine& to_world) {
  const bool face_normals = shape.boolean("face_normals", false);
  if (mesh.triangles.empty()) {
    context.warn_once("empty mesh", shape.element(), "a mesh without triangles is left out");
    return;
  }
  place_mesh(mesh, to_world, face_normals, shape.boolean("flip_normals", false));
  mesh.material = target.material;
  mesh.group = target.group;
  context.scene.meshes.push_back(std::move(mesh));
}

void add_file(Context& context, const Object& shape, const Target& target) {
  const Element* filename = shape.find("filename");
  if (!filename) fail(shape.element(), fmt::format("shape '{}' has no filename", shape.type()));
  const auto path = context.resolve(*filename, filename->required("value"));
  std::vector<std::string> warnings;
  MeshFileOptions options;
  options.warnings = &warnings;
  options.face_normals = shape.boolean("face_normals", false);
  options.flip_v = !shape.boolean("flip_tex_coords", shape.type() == "obj");
  const int index = shape.integer("shape_index").value_or(0);
  Mesh mesh;
  try {
    mesh = shape.type() == "obj"   ? read_obj(path, options)
           : shape.type() == "ply" ? read_ply(path, options)
                                   : read_serialized(path, index, options);
  } catch (const Error& error) {
    return context.leave_out(shape, *filename, error.what());
  }
  for (const std::string& warning : warnings) {
    context.warn_once(warning, *filename, fmt::format("{}: {}", path.string(), warning));
  }
  add_mesh(context, shape, target, std::move(mesh), target.to_world);
}

/// A mesh of LoadOptions::meshes.
void add_memory(Context& context, const Object& shape, const Target& target) {
  const Mesh* mesh = context.memory_mesh(shape.text("data", ""));
  if (!mesh) fail(shape.element(), "shape 'mesh': expected vertices and triangles");
  add_mesh(context, shape, target, *mesh, target.to_world);
}

}  // namespace pt::mitsuba
