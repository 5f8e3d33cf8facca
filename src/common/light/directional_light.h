// Parallel rays from infinitely far.
#pragma once

#include "common/light/light.h"

namespace pt {

struct DirectionalLight {
  static constexpr LightKind kind = LightKind::directional;
  static constexpr bool has_position = false;

  PT_HD static PlainLight sample(const Light& light, const Vec3&, float, float) {
    return {{-light.b, -beyond_scene * light.b, light.radiance, 1.0f, true}};
  }
  static Color power(const DeltaLight& light, float scene_radius) {
    return pi * scene_radius * scene_radius * light.intensity;
  }
};

}  // namespace pt
