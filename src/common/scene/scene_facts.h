// What a scene consists of, for reports.
#pragma once

#include <string>

#include "common/render/stats.h"
#include "common/scene/scene_data.h"

namespace pt {

/// `scene` is prepared.
void describe_scene(const SceneData& scene, SceneFacts& facts);

/// What the report says of a tree over triangles; nothing where there is none.
void describe_tree(const TriangleTreeData& tree, SceneFacts& facts);
std::string tree_text(const SceneFacts& facts);

/// Two or three lines for a person: counts, memory, the tree. Empty for the paper's scenes, which
/// have nothing to say.
std::string scene_text(const SceneFacts& facts);

}  // namespace pt
