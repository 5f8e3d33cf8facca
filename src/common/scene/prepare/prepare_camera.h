// The camera's parameters: the scene's own, overridden by the options, checked.
#pragma once

#include "common/options/options.h"
#include "common/scene/data/scene_data.h"

namespace pt {

void override_camera(CameraParameters& camera, const CameraOverrides& overrides);

/// Throws Error naming the option that can mend it when the parameters describe no camera.
void check_camera(const CameraParameters& camera);

/// Takes away a far plane behind all: rays without one are faster.
void drop_idle_far_plane(SceneData& scene);

/// Within this distance of look_from all rays of an image of width x height pixels begin.
float camera_extent(const CameraParameters& parameters, int width, int height);

}  // namespace pt
