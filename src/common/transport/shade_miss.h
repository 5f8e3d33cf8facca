// Step 3a: the ray left the scene.
#pragma once

#include "common/sampling/mis.h"
#include "common/scene/data/scene.h"
#include "common/transport/path.h"

namespace pt {

/// The radiance that the sky adds to the path's sample. The path ends. That of an environment and
/// of the sun is weighted against light sampling, which could have chosen the same direction.
template <Lighting lighting>
PT_HD Color miss_radiance(const Scene& scene, const Vec3& ray_direction, const PathState& path,
                          MisHeuristic mis) {
  lanes_of(scene).at(path.rays - 1u).count(LanePoint::shade_miss);
  if constexpr (lighting == Lighting::full) {
    if (scene.camera.hides_emitters && path.rays == 1) return Color(0.0f);
  }
  Color radiance = sky_radiance(scene.sky, ray_direction);
  if constexpr (lighting == Lighting::full) {
    if (scene.light_selector.environment_probability > 0.0f) {
      const float pdf = scene.light_selector.environment_probability *
                        environment_pdf(scene.environment, ray_direction);
      const Color environment = environment_radiance(scene.environment, ray_direction);
      const float weight = direction_weight(mis, path.bsdf_pdf, pdf);
      radiance = {fused_multiply_add(environment.x, weight, radiance.x),
                  fused_multiply_add(environment.y, weight, radiance.y),
                  fused_multiply_add(environment.z, weight, radiance.z)};
    }
  }
  if constexpr (lighting == Lighting::full) {
    if (is_in_sun(scene.sun, ray_direction)) {
      const float pdf =
          scene.light_selector.distant_pmf(scene.sun.light) * sun_pdf(scene.sun.one_minus_cos);
      radiance =
          add_scaled(radiance, direction_weight(mis, path.bsdf_pdf, pdf), scene.sun.radiance);
    }
  }
  return path.beta * radiance;
}

}  // namespace pt
