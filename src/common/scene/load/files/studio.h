// Light for files that bring none.
#pragma once

#include <string>

#include "common/scene/data/scene_data.h"
#include "common/scene/load/files/load_options.h"

namespace pt {

/// For warnings: what is used where a file has no light.
inline constexpr const char* studio_text =
    "default lighting (bright behind and above the camera; --default-lighting off leaves it out)";

/// Radiance from `direction` (a unit vector) in the studio's own space, where the camera looks
/// towards -z and +y is up in the image: grey, a little darker below, and a broad, soft light from
/// above on the camera's left side and behind it. So white stands out from what is behind it, and
/// so does black.
float studio_radiance(const Vec3& direction);

/// Makes the studio the scene's environment, rotated with the camera, and asks for a measured
/// exposure.
void add_studio(SceneData& scene);

/// Gives a model (glTF, OBJ, PLY), which has its camera, default lighting where it needs that or
/// `options` want it. A model needs it where nothing lights it or, by a small picture through its
/// camera and through the one that `options` make of it, its own lights leave black what is seen:
/// emission alone where less than half of the surfaces get any, lights of KHR_lights_punctual where
/// none does. Returns what is to be said about it; empty: nothing. `is_framed`: the file has no
/// camera.
std::string light_model(const LoadOptions& options, bool is_framed, SceneData& scene);

/// What is to be said about the light of a file in another format, to which default lighting is
/// added where `options` want it.
std::string light_scene(const LoadOptions& options, SceneData& scene);

}  // namespace pt
