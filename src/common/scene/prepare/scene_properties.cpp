#include "common/scene/prepare/scene_properties.h"

#include <algorithm>

#include "common/geometry/half_spheres.h"
#include "common/scene/prepare/list_lights.h"
#include "common/scene/prepare/prepare_materials.h"

namespace pt {
namespace {

/// Kernels without triangles know the paper's materials alone, which have no back.
bool needs_triangles(const MaterialDescription& material) {
  const bool has_black_back = material.one_sided && !is_black(material.parameters[0].value);
  return has_black_back || material.node != MaterialNode::none || !material.opacity.is_opaque() ||
         static_cast<int>(material.kind) >= PaperBsdfs::size;
}

}  // namespace

bool has_primitives_only(const SceneData& scene) {
  return !is_limited(scene.camera) && !scene.camera.orthographic && scene.meshes.empty() &&
         scene.delta_lights.empty() && scene.environment.width == 0 &&
         scene.sun.one_minus_cos == 0.0f && scene.textures.empty() && scene.sphere_frames.empty() &&
         scene.media.empty() && std::ranges::none_of(scene.materials, needs_triangles);
}

SceneProperties properties_of(const SceneData& scene) {
  const auto is_masked = [](const MaterialDescription& m) { return !m.opacity.is_opaque(); };
  SceneProperties properties;
  properties.name = scene.name;
  properties.spheres = scene.spheres.size();
  properties.quads = scene.quads.size();
  properties.triangles = scene.triangle_count();
  properties.instances = scene.instances.size();
  properties.is_primitive_only = has_primitives_only(scene);
  properties.has_masks =
      is_limited(scene.camera) || std::ranges::any_of(scene.materials, is_masked);
  properties.has_media = needs_media(scene);
  properties.has_open_boundaries =
      scene.media_overlap ||
      std::ranges::any_of(scene.materials, [](const auto& m) { return m.passes; });
  properties.has_emitters = std::ranges::any_of(
      scene.material_records, [](const Material& m) { return m.emission != no_emission; });
  properties.has_rough_conductors = std::ranges::any_of(scene.materials, is_rough_conductor);
  properties.bsdf_kinds = kinds_of(scene);
  properties.emitters = emitter_count(scene);
  constexpr std::size_t group = HalfSpheres::count;
  properties.scan_bytes = (scene.spheres.size() + group - 1) / group * sizeof(HalfSpheres);
  return properties;
}

}  // namespace pt
