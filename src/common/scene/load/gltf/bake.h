// Meshes in world space.
#pragma once

#include "common/geometry/mesh.h"
#include "common/math/transform.h"
#include "common/scene/load/gltf/document/file.h"

namespace pt::gltf {

/// How a map turns normals: by its cofactors, the inverse's transpose up to a factor, and without a
/// division that a flattened mesh would not survive. Their length is not kept.
struct Cofactors {
  Vec3 columns[3];

  explicit Cofactors(const Affine& map);
  Vec3 normal(const Vec3& n) const {
    return n.x * columns[0] + n.y * columns[1] + n.z * columns[2];
  }
};

/// Puts a mesh into world space. A mirroring transformation exchanges two vertices of each
/// triangle, so that front stays front (specification, section 3.7.4).
/// `place` is that of the node, for warnings.
void bake(File& file, const Affine& to_world, const std::string& place, Mesh& mesh);

/// For a mesh whose positions and normals, these by Cofactors, have been moved: turns triangles and
/// normals of mirrored meshes, gives normals their length, and leaves out triangles that overflow.
void finish_baking(File& file, bool mirrors, const std::string& place, Mesh& mesh);

}  // namespace pt::gltf
