// Several sets of texture coordinates (TEXCOORD_n), of which a Mesh has one.
#pragma once

#include <vector>

#include "common/scene/load/gltf/meshes.h"
#include "common/scene/load/gltf/textures.h"

namespace pt::gltf {

/// Triangles whose textures' sets are affine functions of the mesh's coordinates.
struct UvPart {
  Mesh mesh;
  UvMaps maps;
};

/// The sets that the textures of a material (-1: the default material) use, that of the normal map
/// first, since it says what the tangents are, then by the number of textures.
std::vector<int> sets_of_textures(const File& file, int material);

/// The primitive with one set as its coordinates. Within a triangle any other set is an affine
/// function of it, so that it moves into the textures' transforms: of all triangles where one
/// function serves them (the other set is scaled, turned or moved, or the same), else by charts,
/// and at worst by triangles. Of sets that are missing others are used, which is reported.
std::vector<UvPart> split_by_uv_sets(File& file, PrimitiveMesh primitive, std::vector<int> sets,
                                     const std::string& place);

}  // namespace pt::gltf
