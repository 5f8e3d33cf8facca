// Cameras.
#pragma once

#include "common/geometry/bounds.h"
#include "common/scene/data/scene_data.h"
#include "common/scene/load/gltf/nodes.h"

namespace pt::gltf {

/// Sets the scene's camera and the image's shape from the first node with a camera; false if there
/// is none. An orthographic camera becomes a perspective one far away that sees as much at the
/// middle of `bounds`, the scene's.
bool set_camera(File& file, const std::vector<PlacedNode>& nodes, const Bounds& bounds,
                SceneData& scene);

}  // namespace pt::gltf
