// The bounds of a scene, and a camera for scenes without one.
#pragma once

#include "common/geometry/bounds.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// The bounds of everything in world space. Those of instances may be too large: they are the
/// transformed boxes of their groups.
Bounds scene_bounds(const SceneData& scene);

/// A camera that sees all of the scene from the front, right and above (+z, +x and +y) in an image
/// of any shape: the scene nearly fills the smaller side. It looks at the middle of the bounds.
CameraParameters frame_scene(const SceneData& scene);

}  // namespace pt
