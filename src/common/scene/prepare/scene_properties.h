// What a plan needs to know of a scene.
#pragma once

#include "common/scene/data/scene_data.h"

namespace pt {

/// The properties of a scene whose materials and media are prepared. `structure` is for
/// prepare_scene() to fill in.
SceneProperties properties_of(const SceneData& scene);

/// Whether the scene has nothing that the paper's have not.
bool has_primitives_only(const SceneData& scene);

}  // namespace pt
