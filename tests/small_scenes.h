// Every built-in scene, small enough for a test that renders it.
#pragma once

#include <string>
#include <vector>

#include "common/scene/builtin_scenes.h"

namespace pt {

/// Names as --scene takes them: generated scenes with a thousand of what they are made of.
inline std::vector<std::string> small_scenes() {
  std::vector<std::string> names;
  for (const SceneInfo& info : scene_list()) {
    Options options;
    options.scene = info.parameter.empty() ? info.name : info.name + ":1K";
    // Meshes are not rendered yet: this condition goes when prepare_scene() accepts them.
    if (build_scene(options).primitive_count() > 0) names.push_back(options.scene);
  }
  return names;
}

}  // namespace pt
