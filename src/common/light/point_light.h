// A point that shines everywhere alike.
#pragma once

#include "common/light/light_bounds.h"

namespace pt {

struct PointLight {
  static constexpr LightKind kind = LightKind::point;
  static constexpr bool has_position = true;

  PT_HD static PlainLight sample(const Light& light, const Vec3& from, float, float) {
    return sample_place(light.a, light.radiance, from, [](const Vec3&) { return 1.0f; });
  }
  static LightBounds bounds(const Light& light) { return bounds_of_place(light); }
  static Color power(const DeltaLight& light, float) { return 4.0f * pi * light.intensity; }
};

}  // namespace pt
