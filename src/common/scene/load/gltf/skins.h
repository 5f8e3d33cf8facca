// Skins: meshes that joints place.
#pragma once

#include <unordered_map>
#include <vector>

#include "common/math/transform.h"
#include "common/scene/load/gltf/meshes.h"

namespace pt::gltf {

/// Of each joint of a skin: from the mesh's space, as it was bound, to the world. `places`: of
/// the scene's nodes, by number. Empty, and a warning, where the skin or a joint is missing.
std::vector<Affine> joint_matrices(File& file, int skin,
                                   const std::unordered_map<int, Affine>& places,
                                   const std::string& place);

/// Puts a mesh into world space by its joints; the transformation of its node has no part in it
/// (specification, section 3.7.3.3).
void apply_skin(File& file, const std::vector<Affine>& joints, const Influences& influences,
                const std::string& place, Mesh& mesh);

}  // namespace pt::gltf
