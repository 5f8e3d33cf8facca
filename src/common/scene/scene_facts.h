// What a scene consists of, for reports.
#pragma once

#include <string>

#include "common/render/stats.h"
#include "common/scene/scene_data.h"

namespace pt {

/// `scene` is prepared.
void describe_scene(const SceneData& scene, SceneFacts& facts);

/// Two or three lines for a person: counts, memory, the tree. Empty for the paper's scenes, which
/// have nothing to say.
std::string scene_text(const SceneFacts& facts);

}  // namespace pt
