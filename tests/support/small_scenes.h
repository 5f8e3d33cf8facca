// Every built-in scene, small enough for a test that renders it.
#pragma once

#include <string>
#include <vector>

#include "common/scene/builtin/builtin_scenes.h"

namespace pt {

/// Names as --scene takes them: generated scenes with a thousand of what they are made of.
inline std::vector<std::string> small_scenes() {
  std::vector<std::string> names;
  for (const SceneInfo& info : scene_list()) {
    const bool scaled = info.parameter == "N";
    names.push_back(scaled ? info.name + ":1K" : info.name);
  }
  return names;
}

/// Those of spheres and quads alone.
inline std::vector<std::string> primitive_scenes() {
  return {"spheres", "rtow", "cornell", "furnace"};
}

}  // namespace pt
