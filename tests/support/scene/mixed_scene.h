// A scene of everything that rays can meet.
#pragma once

#include "accel/instanced_meshes.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// Instances, spheres, a quad, and a lamp that is an instance.
inline SceneData mixed_scene() {
  const InstancedMeshes world = make_instanced_meshes(30);
  SceneData scene;
  scene.name = "mixed";
  scene.meshes = world.meshes, scene.instances = world.instances;
  scene.add_material(make_diffuse(Color(0.6f, 0.7f, 0.5f)));
  const std::uint32_t glow = scene.add_material(make_diffuse(Color(0.0f), Color(3.0f)));
  scene.meshes[4].material = glow;
  TestRandom random(8);
  for (int i = 0; i < 30; ++i)
    scene.add_sphere(point_in_cube(random, 30), 3, i % 9 == 0 ? glow : 0);
  scene.add_quad({-60, -45, -60}, {0, 0, 120}, {120, 0, 0}, 0);
  scene.sky = {Color(0.4f), Color(0.5f, 0.6f, 0.9f)};
  scene.camera = {{70, 40, 70}, {0, 0, 0}, {0, 1, 0}, 45.0f, 0.0f, 100.0f};
  return scene;
}

}  // namespace pt
