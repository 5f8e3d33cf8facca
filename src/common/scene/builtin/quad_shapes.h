// Simple shapes of quads, added to a scene.
#pragma once

#include "common/scene/data/scene_data.h"

namespace pt {

/// A box of six quads whose normals point outward (or inward), turned about the y axis.
void add_quad_box(SceneData& scene, const Vec3& center, const Vec3& size, float turn_degrees,
                  std::uint32_t material, bool inward = false);

}  // namespace pt
