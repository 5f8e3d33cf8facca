// Meshes: primitives as triangles, put into the world by nodes or joints, with the texture
// coordinates (TEXCOORD_n) of which a Mesh has one set.
#pragma once

#include <map>
#include <unordered_map>
#include <vector>

#include "common/geometry/mesh.h"
#include "common/math/transform.h"
#include "common/scene/load/gltf/document.h"
#include "common/scene/load/gltf/materials.h"

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

// Meshes in world space.

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

// Skins: meshes that joints place.

/// For each joint of a skin: from the mesh's space, as it was bound, to the world. `places`: the
/// transformations of the scene's nodes, by number. Empty, and a warning, where the skin or a joint
/// is missing.
std::vector<Affine> joint_matrices(File& file, int skin,
                                   const std::unordered_map<int, Affine>& places,
                                   const std::string& place);

/// Puts a mesh into world space by its joints; the transformation of its node has no part in it
/// (specification, section 3.7.3.3).
void apply_skin(File& file, const std::vector<Affine>& joints, const Influences& influences,
                const std::string& place, Mesh& mesh);

// Several sets of texture coordinates (TEXCOORD_n), of which a Mesh has one.

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
