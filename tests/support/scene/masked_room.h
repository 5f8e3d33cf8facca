// Masks of all kinds on triangles alone, between a lamp and what it shines on.
#pragma once

#include "scene/lamp_rooms.h"
#include "scene/nested_scenes.h"
#include "statistics.h"

namespace pt {

/// Pairs of triangles of which a part is there, by chance or by a cutoff, everywhere alike or as a
/// picture says. A ray may meet both of a pair, which lie side by side or in one another.
inline SceneData masked_room() {
  SceneData scene;
  scene.name = "masked room";
  std::vector<Color> spots;
  for (int i = 0; i < 16; ++i) spots.emplace_back(0.3f + 0.02f * static_cast<float>(i * 7 % 16));
  const std::uint32_t picture = add_picture(scene, 4, 4, spots);
  std::vector<std::uint32_t> veils;
  for (const Opacity& opacity :
       {constant_opacity(0.3f), constant_opacity(0.6f), textured_opacity(1.0f, picture),
        textured_opacity(0.8f, picture), textured_opacity(1.0f, picture, 0.45f)}) {
    const auto i = static_cast<float>(veils.size());
    MaterialDescription veil = make_diffuse({0.9f - 0.1f * i, 0.5f, 0.2f + 0.15f * i});
    if (veils.empty()) veil.emission.radiance = {0.5f, 0.2f, 0.1f};
    veil.opacity = opacity;
    veils.push_back(scene.add_material(veil));
  }
  TestRandom random(5);
  const auto vec = [&random](float size) {
    return size * Vec3(random.unit() - 0.5f, random.unit() - 0.5f, random.unit() - 0.5f);
  };
  for (std::size_t i = 0; i < 90; ++i) {
    const Vec3 p = vec(3.0f), a = vec(2.0f), b = vec(2.0f);
    const Vec3 shift = i % 3 == 0 ? Vec3(0.0f) : vec(0.1f);
    Mesh leaf;
    leaf.positions = {p, p + a, p + b, p + shift, p + a + shift, p + b + shift};
    leaf.triangles = {{{0, 1, 2}}, {{3, 4, 5}}};
    if (i % 2 == 0) leaf.uvs = {{0, 0}, {2, 0}, {0, 2}, {0, 0}, {1, 0}, {0, 1}};
    leaf.material = veils[i % veils.size()];
    scene.meshes.push_back(leaf);
  }
  const std::uint32_t grey = add_diffuse(scene, Color(0.6f));
  const std::uint32_t glow = scene.add_material(make_diffuse(Color(0.0f), {9, 8, 6}));
  scene.meshes.push_back(parallelogram({}, {-3, -2, -3}, {0, 0, 6}, {6, 0, 0}, grey));
  scene.meshes.push_back(parallelogram({}, {-3, -2, -3}, {6, 0, 0}, {0, 5, 0}, grey));
  scene.meshes.push_back(parallelogram({}, {-1, 2.5f, -1}, {2, 0, 0}, {0, 0, 2}, glow));
  scene.sky = {Color(0.1f), {0.2f, 0.3f, 0.5f}};
  scene.camera = {{1, 1, 5}, {0, 0, 0}, {0, 1, 0}, 45.0f, 0.0f, 5.0f};
  return scene;
}

/// The same through a camera that does not see all of it: a near plane, a far plane, and lamps that
/// camera rays do not meet.
inline SceneData limited_room() {
  SceneData scene = masked_room();
  scene.camera.near_clip = 4, scene.camera.far_clip = 6, scene.camera.hides_emitters = true;
  return scene;
}

/// Spheres among a room's surfaces, one of which glows.
inline void add_spheres(SceneData& scene) {
  const std::uint32_t grey = add_diffuse(scene, Color(0.5f));
  const std::uint32_t glow = scene.add_material(make_diffuse(Color(0.0f), {2, 4, 6}));
  for (int i = 0; i < 6; ++i) {
    const auto x = static_cast<float>(i) - 2.5f;
    scene.add_sphere({0.6f * x, 0.3f * x, 0.4f * x * x}, 0.35f, i % 3 == 0 ? glow : grey);
  }
}

/// The masked room's leaves in three groups, each of which two instances repeat.
inline SceneData masked_forest() {
  SceneData scene = masked_room();
  scene.name = "masked forest";
  for (std::size_t i = 0; i < 90; ++i)
    scene.meshes[i].group = static_cast<std::uint32_t>(1 + i % 3);
  for (std::uint32_t group = 1; group <= 3; ++group) {
    const auto turn = 35.0f * static_cast<float>(group);
    scene.instances.push_back({group, rotate({0, 1, 0}, turn) * scale({0.8f, 1.1f, 0.7f})});
    scene.instances.push_back({group, translate({0.5f, 0.3f, -0.4f}) * scale({-1, 0.6f, 1})});
  }
  return scene;
}

}  // namespace pt
