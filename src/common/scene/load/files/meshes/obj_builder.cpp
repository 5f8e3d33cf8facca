#include "common/scene/load/files/meshes/obj_builder.h"

namespace pt {

std::size_t ObjMeshBuilder::Hash::operator()(const ObjCorner& corner) const {
  // Products by odd constants, the high half folded in, spread neighbours over the table.
  std::uint64_t hash = corner.position * 0x9e3779b97f4a7c15u;
  hash = (hash ^ (hash >> 32) ^ corner.uv) * 0xbf58476d1ce4e5b9u;
  hash = (hash ^ (hash >> 32) ^ corner.normal) * 0x94d049bb133111ebu;
  return hash ^ (hash >> 32);
}

std::uint32_t ObjMeshBuilder::vertex_of(const ObjCorner& corner, const ObjVertices& vertices) {
  const auto next = static_cast<std::uint32_t>(mesh_.positions.size());
  const auto [entry, is_new] = vertex_of_.try_emplace(corner, next);
  if (is_new) {
    has_uvs_ |= corner.uv != obj_none;
    has_normals_ |= corner.normal != obj_none;
    mesh_.positions.push_back(vertices.positions[corner.position]);
    if (corner.position < vertices.colors.size()) {
      mesh_.colors.resize(next, Color(1.0f));
      mesh_.colors.push_back(vertices.colors[corner.position]);
    }
    mesh_.uvs.push_back(corner.uv == obj_none ? Vec2(0.0f) : vertices.uvs[corner.uv]);
    mesh_.normals.push_back(corner.normal == obj_none ? Vec3(0.0f)
                                                      : vertices.normals[corner.normal]);
  }
  return entry->second;
}

void ObjMeshBuilder::add_face(const std::vector<ObjCorner>& corners, const ObjVertices& vertices) {
  const std::uint32_t a = vertex_of(corners[0], vertices);
  std::uint32_t b = vertex_of(corners[1], vertices);
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const std::uint32_t c = vertex_of(corners[i], vertices);
    mesh_.triangles.push_back({{a, b, c}});
    b = c;
  }
  fans_.add(corners.size() - 2);
}

Mesh ObjMeshBuilder::finish(std::vector<std::string>* warnings) && {
  fans_.cut_concave(mesh_, warnings);
  if (!has_uvs_) mesh_.uvs = {};
  if (!has_normals_) mesh_.normals = {};
  if (!mesh_.colors.empty()) mesh_.colors.resize(mesh_.positions.size(), Color(1.0f));
  return std::move(mesh_);
}

}  // namespace pt
