// Counts and memory of a scene, for reports.
#pragma once

#include <string>

#include "common/accel/build/tree_statistics.h"
#include "common/options/stats.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// `scene` is prepared. `has_new_tree`: else the facts of the tree, which cost a walk through it,
/// stay as they are.
void describe_scene(const SceneData& scene, SceneFacts& facts, bool has_new_tree = true);

/// Facts of the tree over the scene's `triangles`.
TreeFacts tree_facts(const TreeSummary& tree, std::uint64_t triangles);

/// Two or three lines of text: counts, memory, the tree. Empty for the paper's scenes.
std::string scene_text(const SceneFacts& facts);

/// The line about the tree; empty where there is none. Part of scene_text().
std::string tree_text(const TreeFacts& tree);

}  // namespace pt
