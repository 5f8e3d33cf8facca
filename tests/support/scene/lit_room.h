// A room with lights of all kinds, seen from within: two walls, a ball of glass, lamps of two
// triangles, of one in an instance and of a sphere, a point, a spot, a directional light, an
// environment and a sun.
#pragma once

#include "common/scene/data/scene_data.h"
#include "scene/lamp_rooms.h"

namespace pt {

inline SceneData lit_room() {
  SceneData scene;
  scene.name = "lit room";
  const std::uint32_t white = scene.add_material(make_diffuse({0.7f, 0.6f, 0.5f}));
  const std::uint32_t glass = scene.add_material(make_dielectric(Color(1.0f), 1.5f));
  const std::uint32_t glow[] = {scene.add_material(make_diffuse(Color(0.0f), {6, 4, 2})),
                                scene.add_material(make_diffuse(Color(0.0f), {2, 5, 9}))};
  const auto add = [&](const Vec3& corner, const Vec3& a, const Vec3& b, std::uint32_t material) {
    scene.meshes.push_back(parallelogram({}, corner, a, b, material));
  };
  add({-4, 0, -4}, {0, 0, 8}, {8, 0, 0}, white);
  add({-4, 0, -4}, {8, 0, 0}, {0, 5, 0}, white);
  add({-4, 0, -4}, {0, 5, 0}, {0, 0, 8}, white);
  for (int i = 0; i < 12; ++i) {
    const auto x = static_cast<float>(i % 4), z = static_cast<float>(i / 4);
    add({-3 + 1.7f * x, 2 + 0.3f * z, -3 + 1.9f * z}, {0.3f + 0.1f * x, 0, 0}, {0, 0.1f * z, 0.4f},
        glow[i % 2]);
  }
  add({0, 0, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}, glow[1]);
  scene.meshes.back().group = 1;
  scene.instances.push_back({1, translate({1, 3, 2}) * scale({-1, 1, 2})});
  scene.instances.push_back({1, translate({2, 1, -2}) * rotate({0, 0, 1}, 40)});
  scene.add_sphere({-1, 0.8f, 0}, 0.8f, glass);
  scene.add_sphere({2, 2, 0.5f}, 0.3f, glow[0]);
  DeltaLight point, spot, far;
  point.position = {-3, 1, 2}, point.intensity = {1, 2, 1};
  spot.kind = LightKind::spot, spot.position = {3, 4, 3}, spot.direction = {-0.6f, -0.8f, 0};
  spot.cos_inner = 0.95f, spot.cos_outer = 0.5f, spot.intensity = {8, 8, 4};
  far.kind = LightKind::directional, far.direction = {0, -0.8f, -0.6f}, far.intensity = Color(0.3f);
  scene.delta_lights = {point, spot, far};
  scene.environment = {4, 3, std::vector<Color>(12, {0.2f, 0.3f, 0.5f}), Affine()};
  scene.environment.pixels[5] = {1, 1, 0.5f};
  scene.sun = {glm::normalize(Vec3(0.5f, 0.7f, 0.6f)), 2e-4f, {900, 800, 700}};
  scene.camera = {{3.8f, 2.5f, 3.8f}, {-1, 1, -1}, {0, 1, 0}, 70.0f, 0.0f, 1.0f};
  return scene;
}

}  // namespace pt
