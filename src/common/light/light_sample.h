// What sampling a light gives, and where a ray to it has to end.
//
// All of it is as seen from the origin of a ray that BSDF sampling would spawn (spawn_origin), not
// from the surface's own point: that origin lies off the surface by its error bound, which far
// from the origin of the scene is no longer small. Then light sampling and BSDF sampling estimate
// one and the same integral, wi and density included.
//
// Only the shadow ray's end differs from the sampled point: it lies off the light, on the side to
// which the light emits, by all that may be rounded between the two (pbrt-v4, section 6.8.6). So
// the ray cannot meet the light itself, and meets whatever lies below it by more than that.
#pragma once

#include "common/math/vec.h"

namespace pt {

struct LightSample {
  Vec3 wi = Vec3(0.0f);   ///< unit vector to the sampled point
  float pdf = 0.0f;       ///< per solid angle; 0: no contribution
  Vec3 end = Vec3(0.0f);  ///< of a shadow ray, relative to its origin
};

/// What a light sends to a point, if nothing lies between.
struct IncidentLight {
  Vec3 wi = Vec3(0.0f);
  Vec3 end = Vec3(0.0f);         ///< of a shadow ray, relative to its origin
  Color radiance = Color(0.0f);  ///< of a delta light: radiance times density
  float pdf = 0.0f;              ///< per solid angle, of light and direction; 0: nothing arrives
  bool is_delta = false;         ///< no BSDF sample could have found it
};

/// Where a light was sampled, without its texture; `uv`: where in that.
struct PlainLight {
  IncidentLight incident;
  Vec2 uv = Vec2(0.0f);
};

/// How far the sampled point and the surface that a ray meets may be apart across the surface.
struct LightError {
  float absolute = 0.0f;  ///< of the light's own size and position
  float relative = 0.0f;  ///< times the distance

  PT_HD float bound(float distance) const {
    return fused_multiply_add(relative, distance, absolute);
  }
};

/// Everything is computed relative to the ray's origin: a vector to the light (3 roundings), its
/// length and direction (5), the shadow ray's (5) and the intersection with the light (up to 12),
/// each half an ulp of the distance or of the light's size. Where the light lies does not matter.
inline constexpr float light_rounding = 32.0f * half_ulp;

/// The end of a ray to a light at infinity: beyond any scene, and its square is a float.
inline constexpr float beyond_scene = 1e18f;

}  // namespace pt
