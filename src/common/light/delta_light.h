// Lights without extent: a point, a spot, a direction.
#pragma once

#include "common/light/light_list.h"

namespace pt {

struct DeltaLightSample {
  Vec3 wi = Vec3(0.0f);
  float distance = 0.0f;
  Color radiance = Color(0.0f);  ///< what arrives, times the delta function's integral
};

/// Cosine smoothed between the angles of full light and of none (pbrt-v4, section 12.2.1).
PT_HD float spot_falloff(float cosine, float cos_inner, float cos_outer) {
  if (cosine >= cos_inner) return 1.0f;
  if (cosine <= cos_outer) return 0.0f;
  const float x = (cosine - cos_outer) / (cos_inner - cos_outer);
  return x * x * (3.0f - 2.0f * x);
}

/// `light` is a delta light.
PT_HD DeltaLightSample sample_delta_light(const Light& light, const Vec3& from) {
  if (light.kind == LightKind::directional) return {-light.b, infinite_distance, light.radiance};
  const Vec3 to_light = light.a - from;
  const float distance2 = glm::dot(to_light, to_light);
  if (distance2 == 0.0f) return {};
  const float distance = sqrtf(distance2);
  const Vec3 wi = to_light / distance;
  float scale = 1.0f / distance2;
  if (light.kind == LightKind::spot) {
    scale *= spot_falloff(-glm::dot(wi, light.b), light.c.x, light.c.y);
  }
  return {wi, distance, scale * light.radiance};
}

}  // namespace pt
