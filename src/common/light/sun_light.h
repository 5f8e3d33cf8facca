// The sun among the lights.
#pragma once

#include "common/light/light.h"
#include "common/light/sun.h"

namespace pt {

struct SunLight {
  static constexpr LightKind kind = LightKind::sun;
  static constexpr bool has_position = false;

  PT_HD static PlainLight sample(const Light& light, const Vec3&, float u0, float u1) {
    const LightSample s = sample_sun(light.b, light.c.x, u0, u1);
    return {{s.wi, s.end, light.radiance, s.pdf}};
  }
};

}  // namespace pt
