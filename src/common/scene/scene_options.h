// Which scenes an option's value is for.
#pragma once

#include "common/render/options.h"
#include "common/scene/scene_data.h"

namespace pt {

/// Whether the lean kernels of the paper's scenes can render it.
bool has_primitives_only(const SceneData& scene);

/// Throws Error when the options ask for what this scene cannot have.
void check_scene_options(const Options& options, const SceneData& scene);

}  // namespace pt
