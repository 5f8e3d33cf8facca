// KHR_lights_punctual.
#pragma once

#include "common/scene/data/scene_data.h"
#include "common/scene/load/gltf/nodes.h"

namespace pt::gltf {

/// Adds the lights of the nodes to the scene. Their units are photometric, so that the exposure
/// must be measured.
void add_lights(File& file, const std::vector<PlacedNode>& nodes, SceneData& scene);

}  // namespace pt::gltf
