// Step 3a: the ray left the scene.
#pragma once

#include "common/sampling/mis.h"
#include "common/scene/scene.h"
#include "common/transport/path.h"

namespace pt {

/// The radiance that the sky adds to the path's sample. The path ends. That of an environment is
/// weighted against light sampling, which could have chosen the same direction.
template <Lighting lighting>
PT_HD Color shade_miss(const Scene& scene, const Vec3& ray_direction, const PathState& path) {
  Color radiance = sky_radiance(scene.sky, ray_direction);
  if constexpr (lighting == Lighting::full) {
    if (scene.light_list.environment_probability > 0.0f) {
      const float pdf = scene.light_list.environment_probability *
                        environment_pdf(scene.environment, ray_direction);
      radiance += environment_radiance(scene.environment, ray_direction) *
                  power_heuristic(path.bsdf_pdf, pdf);
    }
  }
  return path.beta * radiance;
}

}  // namespace pt
