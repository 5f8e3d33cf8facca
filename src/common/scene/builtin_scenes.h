// The scenes that need no file.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/render/options.h"
#include "common/scene/scene_data.h"
#include "common/scene/sphere_world.h"

namespace pt {

struct SceneInfo {
  std::string name;
  std::string description;
};

const std::vector<SceneInfo>& scene_list();

/// Fills a world's arrays: on the host create_sphere_world itself, on the device its kernel.
using SphereWorldCreator =
    std::function<void(SphereWorld& world, SphereWorldKind kind, std::uint32_t count)>;

/// Builds and prepares the scene that the options name. Throws Error when there is none of that
/// name, or when a creator is given for a scene without random spheres.
SceneData make_scene(const Options& options, const SphereWorldCreator& create_world = {});

}  // namespace pt
