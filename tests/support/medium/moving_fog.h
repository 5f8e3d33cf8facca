// A small scene of all that may move or stand beside what moves: media, masks, limits of the view.
#pragma once

#include "medium/medium_scenes.h"
#include "scene/masked_room.h"
#include "scene/moving_room.h"

namespace pt {

/// The moving room in a haze, with a cube of fog that goes and turns, a cloud that stands, a masked
/// thing that turns, lamps that the camera does not see and a camera of a far plane, which turns.
inline SceneData moving_fog_room() {
  SceneData scene = moving_room();
  scene.name = "moving fog";
  constexpr std::uint32_t haze = 0, fog = 1, smoke = 2;
  scene.media = {
      make_medium(Color(0.03f), Color(0.9f)),
      make_medium({1.5f, 2.5f, 1.0f}, Color(0.8f), phase_kind_of<HenyeyGreenstein>, 0.4f),
      make_medium(Color(3.0f), Color(0.7f))};
  TestRandom random(31);
  const Affine place = translate({2, 0.5f, 1}) * scale(Vec3(0.35f));
  scene.media[smoke].density_grid =
      add_grid(scene, random_volume(random, {6, 5, 7}, 1, true,
                                    place * scale(Vec3(2.0f)) * translate(Vec3(-0.5f))));
  scene.camera_medium = haze;
  const auto box = [&](std::uint32_t inside, const Affine& at) {
    Mesh mesh;
    add_box(mesh, at);
    mesh.material = scene.add_material(make_boundary(haze, inside));
    return mesh;
  };
  scene.meshes.push_back(box(smoke, place));
  scene.meshes.push_back(box(fog, scale(Vec3(0.4f))));
  scene.meshes.back().group = 3;
  const Affine begin = translate({-0.8f, 0.75f, 0});
  scene.motion.instances.push_back(
      {static_cast<std::uint32_t>(scene.instances.size()),
       {{0.0f, begin}, {1.0f, translate({0.7f, 0.9f, 0.2f}) * rotate({0.2f, 1, 0}, 80)}}});
  scene.instances.push_back({3, begin});
  MaterialDescription leaf = make_diffuse({0.3f, 0.7f, 0.2f});
  leaf.opacity = constant_opacity(0.5f);
  scene.meshes[1].material = scene.add_material(leaf);
  scene.camera.hides_emitters = true, scene.camera.far_clip = 8;
  TransformKey& last = scene.motion.camera.back();
  last.to_world = last.to_world * rotate({0, 1, 0}, 15);
  return scene;
}

}  // namespace pt
