// Cameras.
#pragma once

#include "common/geometry/bounds.h"
#include "common/scene/data/scene_data.h"
#include "common/scene/load/gltf/nodes.h"

namespace pt::gltf {

/// Sets the scene's camera and the image's shape from the first node with a camera; false if there
/// is none. `bounds` are the scene's: the camera is focused on their middle.
bool set_camera(File& file, const std::vector<PlacedNode>& nodes, const Bounds& bounds,
                SceneData& scene);

}  // namespace pt::gltf
