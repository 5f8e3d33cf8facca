// What kernels need to know of media besides what scenes say.
#pragma once

#include "common/scene/data/scene_data.h"

namespace pt {

/// Orders media by their priorities, where one has any, and lists the boundaries of media by
/// material and the places of point-like lights, and bounds the grids of densities: a majorant for
/// each cell of 8^3 voxels or, where a grid would have more than 64^3 of them, larger ones. Throws
/// Error, which names the scene, where more have to be ordered than overlapping_media_max.
void prepare_media(SceneData& scene);

/// Moves the boundaries of media off the surfaces that they touch, by what rays can tell apart, so
/// that a ray meets both and in the right order (docs/design/media.md). What touches nothing keeps
/// its bits. After convert_quads() and prepare_media().
void separate_boundaries(SceneData& scene);

/// As Scene has it. After prepare_media().
std::uint32_t camera_medium_id(const SceneData& scene);

}  // namespace pt
