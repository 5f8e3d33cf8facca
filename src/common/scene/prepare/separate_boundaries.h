// Boundaries of media that lie in other surfaces: fog that stands on a floor.
#pragma once

#include "common/scene/data/scene_data.h"

namespace pt {

/// Moves the boundaries of media off the surfaces that they touch, by what rays can tell apart, so
/// that a ray meets both and in the right order (docs/design/media.md). What touches nothing keeps
/// its bits. After convert_quads() and prepare_materials().
void separate_boundaries(SceneData& scene);

}  // namespace pt
