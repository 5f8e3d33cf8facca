// What the scenes of any size take of the host's memory, asked before it is taken.
#pragma once

#include "common/scene/builtin/builtin_scenes.h"

namespace pt {

/// Of `count` primitives of a request's scene, their acceleration structure included as it is
/// built. Throw Error that names the option.
void check_triangle_memory(const SceneRequest& request, std::uint64_t count);
void check_instance_memory(const SceneRequest& request, std::uint64_t count);
void check_cloud_memory(const SceneRequest& request, std::uint64_t side);
void check_sphere_memory(std::uint64_t count);

}  // namespace pt
