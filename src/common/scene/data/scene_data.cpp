#include "common/scene/data/scene_data.h"

namespace pt {

std::uint32_t SceneData::add_material(const MaterialDescription& material) {
  materials.push_back(material);
  return static_cast<std::uint32_t>(materials.size() - 1);
}

void SceneData::add_sphere(const Vec3& center, float radius, std::uint32_t material) {
  spheres.push_back({center, radius * radius});
  sphere_material.push_back(material);
  if (!sphere_frames.empty()) sphere_frames.emplace_back();
}

void SceneData::add_sphere(const Vec3& center, float radius, std::uint32_t material,
                           const SphereFrame& frame) {
  sphere_frames.resize(spheres.size());
  add_sphere(center, radius, material);
  sphere_frames.resize(spheres.size());
  sphere_frames.back() = frame;
}

void SceneData::add_quad(const Vec3& corner, const Vec3& a, const Vec3& b, std::uint32_t material) {
  quads.push_back(make_quad(corner, a, b));
  quad_material.push_back(material);
}

std::uint64_t SceneData::triangle_count() const {
  std::uint64_t count = 0;
  for (const Mesh& mesh : meshes) count += mesh.triangles.size();
  return count;
}

}  // namespace pt
