#include "common/scene/prepare/convert_quads.h"

#include <map>

#include "common/scene/prepare/prepare_materials.h"

namespace pt {

void convert_quads(SceneData& scene) {
  std::map<std::uint32_t, Mesh> by_material;
  for (std::size_t i = 0; i < scene.quads.size(); ++i) {
    const Quad& quad = scene.quads[i];
    Mesh& mesh = by_material[scene.quad_material[i]];
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const Vec3 a = quad.corner + quad.edge_a, b = quad.corner + quad.edge_b;
    mesh.positions.insert(mesh.positions.end(), {quad.corner, a, a + quad.edge_b, b});
    mesh.uvs.insert(mesh.uvs.end(), {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
    mesh.triangles.push_back({{first, first + 1, first + 2}});
    mesh.triangles.push_back({{first, first + 2, first + 3}});
  }
  for (auto& [material, mesh] : by_material) {
    mesh.material = material;
    mesh.masked = is_masked(scene, scene.materials[material]);
    scene.meshes.push_back(std::move(mesh));
  }
  scene.quads.clear();
  scene.quad_material.clear();
}

}  // namespace pt
