// Sets of rays over a generated terrain.
#pragma once

#include "common/rays/generate_rays.h"
#include "common/scene/prepare/prepare_scene.h"

namespace pt {

/// A prepared scene of meshes and instances, with a camera that sees most of a terrain.
inline SceneData terrain_scene(std::vector<Mesh> meshes, std::vector<Instance> instances = {}) {
  SceneData scene;
  scene.name = "terrain";
  scene.meshes = std::move(meshes);
  scene.instances = std::move(instances);
  scene.add_material(MaterialDescription());
  scene.camera.look_from = {-490, 175, 490};
  scene.camera.look_at = {0, 10, 0};
  prepare_scene(scene);
  return scene;
}

inline RaySet terrain_rays(const Mesh& mesh, RayKind kind, int size) {
  return generate_rays(kind, terrain_scene({mesh}), size);
}

}  // namespace pt
