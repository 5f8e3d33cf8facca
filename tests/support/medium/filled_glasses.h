// Media in glasses of triangles: boundaries that all have a BSDF.
#pragma once

#include "medium/medium_scenes.h"
#include "scene/masked_room.h"

namespace pt {

/// A camera in a thin haze; in it a glass ball of coloured smoke, which glows in places, a rough
/// glass box of red water, a leaf with holes, a floor and two lights. `has_masks`: whether the
/// leaf has its holes.
inline SceneData filled_glasses(bool has_masks = true) {
  TestRandom random(29);
  SceneData scene;
  scene.name = "filled glasses";
  constexpr std::uint32_t smoke = 0, water = 1, haze = 2;
  scene.media.push_back(
      make_medium({1.5f, 0.9f, 3.0f}, Color(0.95f), phase_kind_of<HenyeyGreenstein>, 0.4f));
  scene.media.push_back(make_medium({0.1f, 1.0f, 1.0f}, Color(0.0f)));
  scene.media.push_back(make_medium(Color(0.06f), Color(0.9f)));
  const Affine ball = translate({-1.2f, 0, 0}) * scale(Vec3(2.0f)) * translate(Vec3(-0.5f));
  scene.media[smoke].density_grid =
      add_grid(scene, random_volume(random, {9, 12, 10}, 3, true, ball));
  scene.media[smoke].emission = {0.3f, 0.2f, 0.1f};
  scene.media[smoke].emission_grid =
      add_grid(scene, random_volume(random, {2, 2, 3}, 1, false, ball));
  MaterialDescription glass = make_dielectric(Color(1.0f), 1.3f);
  glass.is_boundary = true, glass.media = {haze, smoke};
  Mesh ball_mesh = make_ball(scene.add_material(glass));
  for (Vec3& p : ball_mesh.positions) p += Vec3(-1.2f, 0, 0);
  scene.meshes.push_back(ball_mesh);
  glass.media = {haze, water};
  add_cuboid(scene, {0.5f, -0.9f, -0.7f}, {1.8f, 0.6f, 0.5f}, scene.add_material(glass));
  MaterialDescription leaf = make_diffuse({0.3f, 0.7f, 0.2f});
  if (has_masks) leaf.opacity = constant_opacity(0.4f);
  scene.add_quad({-1, -0.5f, 1.3f}, {2, 0, 0}, {0, 1, 0.3f}, scene.add_material(leaf));
  add_floor_and_lights(scene);
  scene.camera = {{0.3f, 0.8f, 3.8f}, {0, 0, 0}, {0, 1, 0}, 45.0f, 0.0f, 4.0f};
  scene.camera_medium = haze;
  return scene;
}

}  // namespace pt
