// A sphere that emits, in scenes that list their lights.
#pragma once

#include <cmath>

#include "common/light/area_light.h"
#include "common/light/light_bounds.h"

namespace pt {

struct SphereLight {
  static constexpr LightKind kind = LightKind::sphere;
  static constexpr bool has_position = true;

  PT_HD static PlainLight sample(const Light& light, const Vec3& from, float u0, float u1) {
    const LightSample s = sample_sphere({light.a, light.c.x}, from, u0, u1);
    return {{s.wi, s.end, light.radiance, s.pdf}};
  }
  static LightBounds bounds(const Light& light) {
    LightBounds bounds;
    const Vec3 radius(std::sqrt(light.c.x));
    bounds.box.grow(light.a - radius), bounds.box.grow(light.a + radius);
    bounds.cone = half_turn;
    bounds.emission = quarter_turn;
    bounds.intensity = 0.25f * light.weight;
    return bounds;
  }
};

}  // namespace pt
