// Every built-in scene, small enough for a test that renders it.
#pragma once

#include <string>
#include <vector>

#include "common/scene/builtin/builtin_scenes.h"

namespace pt {

/// Its name as --scene takes it: generated scenes with a thousand of what they are made of.
inline std::string small_scene(const SceneInfo& info) {
  if (info.name == "dial") return "dial:3:0.5:open";
  return info.parameter == "N" ? info.name + ":1K" : info.name;
}

/// By its name and default options.
inline SceneData build_scene(const std::string& name) {
  Options options;
  options.scene = name;
  return build_scene(options);
}

inline std::vector<std::string> small_scenes() {
  std::vector<std::string> names;
  for (const SceneInfo& info : scene_list()) names.push_back(small_scene(info));
  return names;
}

/// Those of spheres and quads alone.
inline std::vector<std::string> primitive_scenes() {
  return {"spheres", "rtow", "cornell", "furnace", "ajar", "caustic"};
}

}  // namespace pt
