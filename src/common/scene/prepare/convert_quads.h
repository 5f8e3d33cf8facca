// Parallelograms as triangles, for scenes that have triangles anyway.
#pragma once

#include "common/scene/data/scene_data.h"

namespace pt {

/// Replaces the scene's quads by meshes of two triangles each, one mesh per material.
void convert_quads(SceneData& scene);

}  // namespace pt
