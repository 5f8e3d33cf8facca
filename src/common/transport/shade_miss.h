// Step 3a: the ray left the scene.
#pragma once

#include "common/scene/scene.h"
#include "common/transport/path.h"

namespace pt {

/// The radiance that the sky adds to the path's sample. The path ends.
PT_HD Color shade_miss(const Scene& scene, const Vec3& ray_direction, const PathState& path) {
  return path.beta * sky_radiance(scene.sky, ray_direction);
}

}  // namespace pt
