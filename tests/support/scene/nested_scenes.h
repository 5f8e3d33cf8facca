// Small scenes with materials made of materials, and what they have in common.
#pragma once

#include <cstring>
#include <vector>

#include "common/scene/data/scene_data.h"
#include "common/scene/prepare/prepare_scene.h"

namespace pt {

/// A picture of colours in the scene's own texel memory, from its foot up; `look` says the rest.
inline std::uint32_t add_picture(SceneData& scene, std::uint32_t width, std::uint32_t height,
                                 const std::vector<Color>& colors, Texture look = {}) {
  look.format = TextureFormat::rgb32f;
  look.width = width, look.height = height;
  look.offset = (scene.texels.size() + 15) / 16 * 16;
  scene.texels.resize(look.offset + sizeof(Color) * colors.size());
  for (std::uint32_t y = 0; y < height; ++y) {
    std::memcpy(&scene.texels[look.offset + sizeof(Color) * width * y],
                &colors[width * (height - 1 - y)], sizeof(Color) * width);
  }
  scene.textures.push_back(look);
  return static_cast<std::uint32_t>(scene.textures.size() - 1);
}

inline Texture nearest_look() {
  Texture look;
  look.filter = TextureFilter::nearest;
  return look;
}

/// A wall in the plane z = 0 that fills the view; u grows along x, v along y; its normal is +z.
inline Mesh wall_mesh(std::uint32_t material, float z = 0.0f, float half = 10.0f) {
  Mesh mesh;
  mesh.positions = {{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  mesh.material = material;
  return mesh;
}

/// Seen from z = 5, or from behind; the sky is white.
inline void look_at_wall(SceneData& scene, float z = 5.0f) {
  scene.camera = {{0.3f, 0.2f, z}, {0.1f, 0.1f, 0}, {0, 1, 0}, 40.0f, 0.0f, 5.0f};
}

inline std::uint32_t add_diffuse(SceneData& scene, const Color& albedo, bool one_sided = false) {
  MaterialDescription m = make_diffuse(albedo);
  m.one_sided = one_sided;
  return scene.add_material(m);
}

}  // namespace pt
