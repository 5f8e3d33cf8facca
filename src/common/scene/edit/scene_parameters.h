// The parameters of a scene in memory that can be changed, by name: "camera.fov",
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
  /// Shape of an array, row by row; empty: one number.
  std::vector<std::size_t> shape;
  bool is_of_camera = false;
  std::function<std::vector<float>(const SceneData&)> get;
  /// Takes as many numbers as get() returns. Throws Error for values that are not possible.
  std::function<void(SceneData&, std::span<const float>)> set;
};

/// The parameters of an unprepared scene: its camera, the parameters of its materials, the radiance
/// of its lights, the places of its instances.
std::vector<SceneParameter> scene_parameters(const SceneData& scene);

}  // namespace pt
