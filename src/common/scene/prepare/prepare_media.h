// What kernels need to know of media besides what scenes say.
#pragma once

#include "common/scene/data/scene_data.h"

namespace pt {

/// Lists the boundaries of media by material and the places of point-like lights, and bounds the
/// grids of densities: a majorant for each cell of 8^3 voxels or, where a grid would have more than
/// 64^3 of them, larger ones.
void prepare_media(SceneData& scene);

}  // namespace pt
