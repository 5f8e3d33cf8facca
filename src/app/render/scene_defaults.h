// What a scene's file asks for, where the user does not.
#pragma once

#include "app/options/check_options.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// Fills in what `given` lacks and the scene has. Throws Error for a part of the image that is none
/// (check_crop).
void apply_defaults(const SceneDefaults& defaults, const GivenOptions& given, Options& options);

}  // namespace pt
