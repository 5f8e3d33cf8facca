// What of a scene can be changed while it stays in memory, by name: "camera.fov",
// "materials.red.albedo", "lights.lamp.radiance", "instances.3.to_world".
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "common/scene/data/scene_data.h"

namespace pt {

struct SceneParameter {
  std::string name;
  /// Of an array, row by row; empty: one number.
  std::vector<std::size_t> shape;
  bool is_of_camera = false;
  std::function<std::vector<float>(const SceneData&)> get;
  /// Of as many numbers as get() returns. Throws Error for what the parameter cannot be.
  std::function<void(SceneData&, std::span<const float>)> set;
};

/// Of a scene that is not prepared: its camera, the parameters of its materials, what its lights
/// radiate, where its instances are. Materials without a name are "material_N".
std::vector<SceneParameter> scene_parameters(const SceneData& scene);

}  // namespace pt
