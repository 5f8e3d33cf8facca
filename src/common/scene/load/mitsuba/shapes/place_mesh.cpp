#include "common/scene/load/mitsuba/shapes/place_mesh.h"

#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/files/meshes/move_mesh.h"

namespace pt::mitsuba {

void place_mesh(Mesh& mesh, const Affine& to_world, bool face_normals, bool flip_normals) {
  if (face_normals) mesh.normals.clear();
  transform_mesh(mesh, to_world);
  if (mesh.normals.empty() && !face_normals) compute_vertex_normals(mesh);
  if (flip_normals) turn_mesh(mesh);
  if (!mesh.normals.empty()) wind_by_normals(mesh);
}

}  // namespace pt::mitsuba
