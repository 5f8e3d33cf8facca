// Light for files that bring none.
#pragma once

#include "common/scene/data/scene_data.h"

namespace pt {

/// For warnings: what is used where a file has no light.
inline constexpr const char* studio_text = "a soft studio, bright behind and above the camera";

/// Radiance from `direction` (a unit vector) in the studio's own space, where the camera looks
/// towards -z and +y is up in the image: grey, a little darker below, and a broad, soft light from
/// above on the camera's left side and behind it. So white stands out from what is behind it, and
/// so does black.
float studio_radiance(const Vec3& direction);

/// Makes the studio the scene's environment, rotated with the camera, and asks for a measured
/// exposure.
void add_studio(SceneData& scene);

}  // namespace pt
