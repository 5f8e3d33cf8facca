// The built-in scenes that are made of quads and spheres.
#pragma once

#include "common/scene/data/scene_data.h"

namespace pt {

/// Goral et al. 1984, with the measured reflectances rounded as in the Cornell Box of most papers.
SceneData make_cornell_scene();

/// The Cornell Box filled with fog, a homogeneous medium that ends at its open side.
SceneData make_fog_scene();

/// Everything here emits e and reflects 1 - e of what arrives, so every ray carries radiance 1.
SceneData make_furnace_scene();

}  // namespace pt
