// Delta lights (pbrt-v4, sections 12.2 and 12.3): no ray can hit them, so that light sampling alone
// finds them, with MIS weight 1.
#pragma once

#include "common/light/light_kind.h"
#include "common/light/light_sample.h"
#include "common/texture/texture.h"

namespace pt {

/// The falloff of a spot light's intensity between its inner and its outer angle.
enum class SpotFalloff : std::uint32_t {
  smooth,         ///< pbrt's: smoothstep of the cosine
  linear_angle,   ///< Mitsuba's: linear in the angle
  square_cosine,  ///< glTF's KHR_lights_punctual: square of linear in the cosine
};

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

/// Of `intensity` times share(wi) at a place. There is nothing to choose. Black at the place
/// itself.
template <class Share>
PT_HD PlainLight sample_place(const Vec3& position, const Color& intensity, const Vec3& from,
                              const Share& share) {
  PlainLight result;
  IncidentLight& incident = result.incident;
  incident.pdf = 1.0f, incident.is_delta = true;
  const Vec3 to_light = position - from;
  const float distance2 = dot(to_light, to_light);
  if (distance2 == 0.0f) return result;
  const float inverse_distance = inverse_sqrt(distance2);
  const Vec3 wi = inverse_distance * to_light;
  // A light on a surface shines in front of it: its position has been rounded.
  const float error = 4.0f * half_ulp * max_abs(position) * inverse_distance + light_rounding;
  incident.wi = wi;
  incident.end = fmaxf(1.0f - error, 0.5f) * to_light;
  incident.radiance = intensity * (share(wi) / distance2);
  return result;
}

}  // namespace pt
