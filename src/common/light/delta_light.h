// Delta lights (pbrt-v4, sections 12.2 and 12.3): no ray can hit them, so that light sampling alone
// finds them, with MIS weight 1.
#pragma once

#include "common/light/light_sample.h"
#include "common/texture/texture.h"

namespace pt {

/// The falloff of a spot light's intensity between its inner and its outer angle.
enum class SpotFalloff : std::uint32_t {
  smooth,         ///< pbrt's: smoothstep of the cosine
  linear_angle,   ///< Mitsuba's: linear in the angle
  square_cosine,  ///< glTF's KHR_lights_punctual: square of linear in the cosine
};

/// Every kind of light but the environment; the delta lights come last, the sun before them. A
/// flipped triangle has its last two vertices exchanged: its instance's transformation mirrors,
/// which would otherwise flip the emitting side.
enum class LightKind : std::uint8_t {
  triangle,
  flipped_triangle,
  sphere,
  sun,
  point,
  spot,
  projector,
  directional
};

PT_HD bool is_triangle(LightKind kind) { return kind <= LightKind::flipped_triangle; }
PT_HD bool has_position(LightKind kind) {
  return kind != LightKind::sun && kind != LightKind::directional;
}
PT_HD bool is_delta(LightKind kind) { return kind >= LightKind::point; }

struct DeltaLight {
  LightKind kind = LightKind::point;
  Vec3 position{0.0f};       ///< point, spot: world space
  Vec3 direction{0, 0, -1};  ///< spot, directional: away from the light, unit length
  Color intensity{1.0f};     ///< point, spot: W / sr; directional: W / m^2 across the rays
  float cos_inner = 1.0f;    ///< spot: full intensity within this angle,
  float cos_outer = -1.0f;   ///< none beyond this one,
  SpotFalloff falloff = SpotFalloff::smooth;  ///< in between
  Vec3 right{1, 0, 0};  ///< direction of the picture's u; projector: of length 1 / tan(fov / 2);
                        ///< spot: of unit length
  float aspect = 1.0f;  ///< width over height; negative where the map to the world mirrors
  std::uint32_t texture = no_texture;  ///< the picture; projector: of intensity / cos^3 about the
                                       ///< axis; spot: multiplies the intensity
};

/// The falloff, in [0, 1], of a spot light in a direction whose angle to the axis has this cosine.
PT_HD float spot_share(const DeltaLight& light, float cosine) {
  if (cosine >= light.cos_inner) return 1.0f;
  if (cosine <= light.cos_outer) return 0.0f;
  if (light.falloff == SpotFalloff::linear_angle) {
    const float outer = acosf(light.cos_outer);
    return (outer - acosf(cosine)) / (outer - acosf(light.cos_inner));
  }
  const float t = (cosine - light.cos_outer) / (light.cos_inner - light.cos_outer);
  return light.falloff == SpotFalloff::smooth ? t * t * (3.0f - 2.0f * t) : t * t;
}

struct DeltaLightSample {
  Vec3 wi = Vec3(0.0f);            ///< unit vector to the light
  Vec3 end = Vec3(0.0f);           ///< of a shadow ray, relative to its origin
  Color irradiance = Color(0.0f);  ///< W / m^2 across wi; times f |cos|: the reflected radiance
};

/// Deterministic. Black at the light's own position.
PT_HD DeltaLightSample sample_delta_light(const DeltaLight& light, const Vec3& from) {
  if (light.kind == LightKind::directional) {
    return {-light.direction, -beyond_scene * light.direction, light.intensity};
  }
  const Vec3 to_light = light.position - from;
  const float distance2 = dot(to_light, to_light);
  if (distance2 == 0.0f) return {};
  const float inverse_distance = inverse_sqrt(distance2);
  const Vec3 wi = inverse_distance * to_light;
  const float share =
      light.kind == LightKind::spot ? spot_share(light, -dot(light.direction, wi)) : 1.0f;
  // A light on a surface illuminates the side in front of it, though its position is rounded.
  const float error = 4.0f * half_ulp * max_abs(light.position) * inverse_distance + light_rounding;
  return {wi, fmaxf(1.0f - error, 0.5f) * to_light, light.intensity * (share / distance2)};
}

/// Power in W, for light selection; of a directional light through a disk of `scene_radius`. A
/// spot's is estimated as in pbrt-v4, section 12.2.1: a cone with the mean of both angles' cosines.
PT_HD Color delta_light_power(const DeltaLight& light, float scene_radius) {
  switch (light.kind) {
    case LightKind::point:
      return 4.0f * pi * light.intensity;
    case LightKind::projector:
      return 4.0f / (dot(light.right, light.right) * fabsf(light.aspect)) * light.intensity;
    case LightKind::spot:
      return 2.0f * pi * (1.0f - 0.5f * (light.cos_inner + light.cos_outer)) * light.intensity;
    default:
      return pi * scene_radius * scene_radius * light.intensity;
  }
}

}  // namespace pt
