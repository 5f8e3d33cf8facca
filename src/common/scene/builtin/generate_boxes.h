// Boxes in a closed room.
#pragma once

#include "common/scene/data/scene_data.h"

namespace pt {

/// 512 boxes, some on the floor, some in the air, in a room of 20 x 10 x 20 units, all of it times
/// `scale`: 6,158 triangles, two of which are the lamp below the ceiling. Radiances do not depend
/// on the scale, so neither does the image. The room's walls share their corners and have no gap:
/// no ray gets out.
SceneData make_boxes_scene(double scale);

}  // namespace pt
