// What a loader must not get wrong, whatever the file says.
#pragma once

#include "common/scene/data/scene_data.h"
#include "fuzz.h"

namespace pt {

inline void check_that(bool holds) {
  if (!holds) std::abort();
}

/// Aborts where a number of one part of the scene leads out of another.
inline void check_scene(const SceneData& scene) {
  check_that(scene.sphere_material.size() == scene.spheres.size());
  check_that(scene.quad_material.size() == scene.quads.size());
  for (const auto* materials : {&scene.sphere_material, &scene.quad_material}) {
    for (const std::uint32_t material : *materials) check_that(material < scene.materials.size());
  }
  for (const Mesh& mesh : scene.meshes) {
    check_mesh(mesh);
    check_that(mesh.material < scene.materials.size());
  }
  for (const MaterialDescription& material : scene.materials) {
    const auto check_texture = [&](std::uint32_t texture) {
      check_that(texture == no_texture || texture < scene.textures.size());
    };
    for (const Parameter& parameter : material.parameters) check_texture(parameter.texture);
    check_texture(material.emission.texture);
  }
  for (const Texture& texture : scene.textures) {
    if (texture.kind != TextureKind::image) continue;
    const std::uint64_t texel_bytes = texture.format == TextureFormat::rgb32f ? 12 : 4;
    const std::uint64_t size = texel_bytes * texture.width * texture.height;
    check_that(size > 0 && texture.offset <= scene.texels.size() &&
               size <= scene.texels.size() - texture.offset);
  }
}

}  // namespace pt
