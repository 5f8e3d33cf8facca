// The camera's parameters: the scene's own, overridden by the options, checked.
#pragma once

#include "common/options/options.h"
#include "common/scene/data/scene_data.h"

namespace pt {

void override_camera(CameraParameters& camera, const CameraOverrides& overrides);

/// Throws Error naming the option that can mend it when the parameters describe no camera.
void check_camera(const CameraParameters& camera);

/// Takes away clip planes that cut nothing in an image of this size: rays without any are
/// faster.
void drop_idle_clips(SceneData& scene, int width, int height);

}  // namespace pt
