// Lights infinitely far away: parallel rays, and the sun.
#pragma once

#include "common/light/light.h"
#include "common/math/functions.h"
#include "common/math/transform.h"

namespace pt {

struct alignas(16) DirectionalLight {
  static constexpr LightKind type = LightKind::directional;
  static constexpr bool has_position = false;

  float unused_a[3] = {};
  LightKind kind = type;
  Vec3 direction{0, 0, -1};  ///< away from the light, unit length
  float weight = 0.0f;
  float unused_b[4] = {};
  Color radiance{0.0f};  ///< irradiance across the rays, W / m^2
  std::uint32_t emission_texture = no_texture;

  static DirectionalLight make(const DeltaLight& light) {
    DirectionalLight result;
    result.direction = light.direction, result.radiance = light.intensity;
    return result;
  }
  PT_HD PlainLight sample(const Vec3&, float, float) const {
    return {{-direction, -beyond_scene * direction, radiance, 1.0f, true}};
  }
  /// On a disk of the scene's radius.
  Color power(float scene_radius) const { return pi * scene_radius * scene_radius * radiance; }
};

/// The sun, a disk of uniform radiance. By value in the scene, for rays that leave it.
struct Sun {
  Vec3 direction{0, 0, 1};       ///< to it, of unit length
  float one_minus_cos = 0.0f;    ///< of the angle under which its radius is seen; 0: no sun
  Color radiance = Color(0.0f);  ///< W / (m^2 sr)
  std::uint32_t light = 0;       ///< its index among the lights
};

/// Density per solid angle of sample_sun: 1 / (2 pi (1 - cos)) (a uniform cone: pbrt-v4, section
/// A.5.4).
PT_HD float sun_pdf(float one_minus_cos) { return 0.5f * inverse_pi / one_minus_cos; }

/// Whether it is visible in a direction of unit length. Compares chords: the cosine of so small an
/// angle has few significant digits.
PT_HD bool is_in_sun(const Sun& sun, const Vec3& direction) {
  const Vec3 apart = direction - sun.direction;
  return dot(apart, apart) < 2.0f * sun.one_minus_cos;
}

/// Uniform over the disk's solid angle. The shadow ray ends beyond the scene.
PT_HD LightSample sample_sun(const Vec3& direction, float one_minus_cos, float u0, float u1) {
  const float h = u0 * one_minus_cos, sin_theta = fast_sqrt(h * (2.0f - h));
  const SinCos phi = sincos_2pi(u1);
  const Frame frame = make_frame(direction);
  const Vec3 wi = normalize(frame.to_world({sin_theta * phi.cos, sin_theta * phi.sin, 1.0f - h}));
  return {wi, sun_pdf(one_minus_cos), beyond_scene * wi};
}

/// The sun among the lights.
struct alignas(16) SunLight {
  static constexpr LightKind type = LightKind::sun;
  static constexpr bool has_position = false;

  float unused_a[3] = {};
  LightKind kind = type;
  Vec3 direction{0, 0, 1};  ///< see Sun
  float weight = 0.0f;
  float one_minus_cos = 0.0f;  ///< see Sun
  float unused_b[3] = {};
  Color radiance{0.0f};
  std::uint32_t emission_texture = no_texture;

  PT_HD PlainLight sample(const Vec3&, float u0, float u1) const {
    const LightSample s = sample_sun(direction, one_minus_cos, u0, u1);
    return {{s.wi, s.end, radiance, s.pdf}};
  }
};

}  // namespace pt
