// What a film makes of the light that it takes for white.
#pragma once

#include "common/scene/data/scene_data.h"

namespace pt::pbrt {

/// Linear sRGB to the same, of which daylight of this colour temperature (below 4000 K a blackbody)
/// becomes white: pbrt's, after von Kries, by the cones of Bradford.
glm::mat3 white_balance(double kelvins);

/// Changes all lights as the film would change its pixels: the same where surfaces are grey, near
/// it else, for colours multiply light component by component.
void balance_lights(SceneData& scene, double kelvins);

}  // namespace pt::pbrt
