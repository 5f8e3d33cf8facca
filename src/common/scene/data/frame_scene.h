// Where a scene lies, and what a viewer needs to see it that its file does not give.
#pragma once

#include "common/geometry/bounds.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// Of everything in world space, instances included. Those may be larger than need be: the boxes of
/// their groups, turned.
Bounds scene_bounds(const SceneData& scene);

/// A camera that sees all of the scene from the front, right and above (+z, +x and +y) in an image
/// of any shape, whose smaller side the scene all but fills. It looks at the middle of the bounds.
CameraParameters frame_scene(const SceneData& scene);

}  // namespace pt
