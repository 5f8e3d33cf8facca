// Meshes: primitives as triangles.
#pragma once

#include <vector>

#include "common/geometry/mesh.h"
#include "common/scene/load/gltf/document/file.h"

namespace pt::gltf {

struct PrimitiveMesh {
  Mesh mesh;          ///< in the mesh's own space; Mesh::material and Mesh::group are not set
  int material = -1;  ///< number in the file, -1: the default material
};

/// The primitives that are triangles, strips or fans. Throws Error for what is malformed.
std::vector<PrimitiveMesh> read_primitives(File& file, int mesh);

}  // namespace pt::gltf
