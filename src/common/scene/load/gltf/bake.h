// Meshes in world space.
#pragma once

#include "common/geometry/mesh.h"
#include "common/math/transform.h"
#include "common/scene/load/gltf/document/file.h"

namespace pt::gltf {

/// Puts a mesh into world space. A mirroring transformation exchanges two vertices of each
/// triangle, so that front stays front (specification, section 3.7.4).
/// `place` is that of the node, for errors.
void bake(const File& file, const Affine& to_world, const std::string& place, Mesh& mesh);

}  // namespace pt::gltf
