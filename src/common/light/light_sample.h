// Samples of lights, and the ends of shadow rays.
//
// The reference point is the origin of a ray that BSDF sampling would spawn (spawn_origin), not the
// surface's own point: the origin is offset from the surface by its error bound, which is not small
// far from the scene's origin. So light sampling and BSDF sampling estimate the same integral, with
// the same wi and density.
//
// The shadow ray ends off the sampled point, on the side to which the light emits, by the bound of
// all rounding errors between the two (pbrt-v4, section 6.8.6). So the ray does not hit the light
// itself, but hits a surface that covers the light by more than that.
#pragma once

#include "common/math/vec.h"

namespace pt {

struct LightSample {
  Vec3 wi = Vec3(0.0f);   ///< unit vector to the sampled point
  float pdf = 0.0f;       ///< per solid angle; 0: no contribution
  Vec3 end = Vec3(0.0f);  ///< of a shadow ray, relative to its origin
};

/// The light that arrives at a point, if it is not occluded.
struct IncidentLight {
  Vec3 wi = Vec3(0.0f);
  Vec3 end = Vec3(0.0f);         ///< of a shadow ray, relative to its origin
  Color radiance = Color(0.0f);  ///< of a delta light: radiance times density
  float pdf = 0.0f;              ///< per solid angle, of light and direction; 0: nothing arrives
  bool is_delta = false;         ///< no BSDF sample could have found it
};

/// A sample without the light's texture; `uv`: where to look that up.
struct PlainLight {
  IncidentLight incident;
  Vec2 uv = Vec2(0.0f);
};

/// Bound of the distance, across the surface, between the sampled point and a ray's hit point.
struct LightError {
  float absolute = 0.0f;  ///< of the light's own size and position
  float relative = 0.0f;  ///< times the distance

  PT_HD float bound(float distance) const {
    return fused_multiply_add(relative, distance, absolute);
  }
  void grow(const LightError& other) {
    absolute = fmaxf(absolute, other.absolute), relative = fmaxf(relative, other.relative);
  }
};

/// Everything is computed relative to the ray's origin: a vector to the light (3 roundings), its
/// length and direction (5), the shadow ray's (5) and the intersection with the light (up to 12),
/// each half an ulp of the distance or of the light's size. Where the light lies does not matter.
inline constexpr float light_rounding = 32.0f * half_ulp;

/// The end of a ray to a light at infinity: beyond any scene, and its square is a float.
inline constexpr float beyond_scene = 1e18f;

}  // namespace pt
