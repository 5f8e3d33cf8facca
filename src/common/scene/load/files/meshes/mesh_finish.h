// What every reader of meshes does at its end.
#pragma once

#include "common/scene/load/files/meshes/mesh_files.h"

namespace pt {

/// Makes a mesh as mesh_files.h promises of what a file said: drops normals where the options say
/// so, scales the others to unit length, flips v. Normals and uvs have the size of the positions or
/// none. Throws Error naming the vertex whose position is not finite or the triangle (from 0)
/// whose index is out of range.
void finish_mesh(Mesh& mesh, const MeshFileOptions& options);

}  // namespace pt
