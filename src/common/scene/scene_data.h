// A scene in memory, owned: what the built-in scenes and loaders fill in.
#pragma once

#include <string>
#include <vector>

#include "common/render/options.h"
#include "common/scene/scene.h"

namespace pt {

struct SceneData {
  std::string name;
  CameraParameters camera;
  Sky sky;
  std::vector<Sphere> spheres;
  std::vector<Quad> quads;
  std::vector<Material> materials;
  std::vector<std::uint32_t> sphere_material, quad_material;  ///< by sphere, by quad
  // Made from the above by prepare_scene():
  Accel accel = Accel::brute;
  std::vector<Bvh2Node> bvh_nodes;         ///< empty with Accel::brute
  std::vector<std::uint32_t> material_of;  ///< by primitive
  std::vector<std::uint32_t> lights;       ///< primitives that emit
  std::vector<Sphere> scan_spheres;        ///< Primitives::scan
  Vec3 scan_center = Vec3(0.0f);

  std::size_t primitive_count() const { return spheres.size() + quads.size(); }
  SceneTraits traits() const { return {accel, !lights.empty()}; }

  std::uint32_t add_material(const Material& material);
  void add_sphere(const Vec3& center, float radius, std::uint32_t material);
  void add_quad(const Vec3& corner, const Vec3& a, const Vec3& b, std::uint32_t material);
};

/// Applies the options' camera overrides and acceleration structure: checks the camera, builds the
/// structure (which reorders the primitives), lists the lights. Throws Error for a camera or a
/// scene that cannot be rendered.
void prepare_scene(SceneData& scene, const Options& options);

/// A view of `scene` in host memory, valid while `scene` is neither changed nor destroyed.
Scene host_view(const SceneData& scene, int width, int height);

}  // namespace pt
