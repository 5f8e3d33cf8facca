// What every reader of meshes does at its end.
#pragma once

#include "common/scene/load/files/meshes/mesh_files.h"

namespace pt {

/// Makes a mesh as mesh_files.h promises of what a file said: leaves out the triangles with an
/// index that is out of range or a position that is not finite; drops normals where the options say
/// so, scales the others to unit length, flips v. Normals and uvs have the size of the positions or
/// none. Throws Error naming the first triangle (from 0) or vertex that is bad where most are.
/// `warnings`: or null.
void finish_mesh(Mesh& mesh, const MeshFileOptions& options,
                 std::vector<std::string>* warnings = nullptr);

}  // namespace pt
