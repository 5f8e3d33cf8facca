// The scenes that need no file.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/options/options.h"
#include "common/scene/builtin/scene_name.h"
#include "common/scene/builtin/sphere_world.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// Fills a world's arrays: on the host create_sphere_world itself, on the device its kernel.
using SphereWorldCreator =
    std::function<void(SphereWorld& world, SphereWorldKind kind, std::uint32_t count)>;

/// The input of a scene's maker.
struct SceneRequest {
  const SceneName& name;
  const Options& options;
  const SphereWorldCreator& create_world;
};

/// A built-in scene: adding one is adding one of these to the list.
struct SceneInfo {
  std::string name;
  std::string parameter;  ///< what may follow the name and a colon, in a word; empty: nothing
  std::string description;
  std::function<SceneData(const SceneRequest&)> make;

  /// As a user may write it: name[:PARAMETER].
  std::string usage() const { return parameter.empty() ? name : name + "[:" + parameter + "]"; }
};

const std::vector<SceneInfo>& scene_list();

/// Builds the scene that the options name, without preparing it. Throws Error when there is none of
/// that name, for a parameter that it does not take, or when a creator is given for a scene without
/// random spheres.
SceneData build_scene(const Options& options, const SphereWorldCreator& create_world = {});

/// Builds and prepares the scene that the options name. Throws Error as build_scene and
/// prepare_scene do.
SceneData make_scene(const Options& options, const SphereWorldCreator& create_world = {});

// The host's memory that scenes of any size need, checked before it is taken.

/// Check the memory for `count` primitives of a request's scene, their acceleration structure
/// included as it is built. Throw Error that names the option.
void check_triangle_memory(const SceneRequest& request, std::uint64_t count);
void check_instance_memory(const SceneRequest& request, std::uint64_t count);
void check_cloud_memory(const SceneRequest& request, std::uint64_t side);
void check_sphere_memory(std::uint64_t count);

}  // namespace pt
