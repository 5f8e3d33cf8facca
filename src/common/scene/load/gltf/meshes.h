// Meshes: primitives as triangles.
#pragma once

#include <map>
#include <vector>

#include "common/geometry/mesh.h"
#include "common/scene/load/gltf/document/file.h"

namespace pt::gltf {

/// Which joints move each vertex, and by how much: `per_vertex` of each.
struct Influences {
  std::size_t per_vertex = 0;
  std::vector<std::uint32_t> joints;
  std::vector<float> weights;  ///< of a vertex, their sum is 1
};

struct PrimitiveMesh {
  Mesh mesh;  ///< in the mesh's own space; Mesh::material, Mesh::group and Mesh::uvs are not set
  int material = -1;                              ///< number in the file, -1: the default material
  std::map<int, std::vector<Vec2>> uv_sets = {};  ///< TEXCOORD_n, with v up
  Influences influences = {};                     ///< of a skinned mesh
};

/// The primitives that are triangles, strips or fans, with morph targets of these weights. Throws
/// Error for accessors that are malformed; other elements that cannot be used are left out, which
/// is reported.
std::vector<PrimitiveMesh> read_primitives(File& file, int mesh,
                                           const std::vector<double>& weights);

}  // namespace pt::gltf
