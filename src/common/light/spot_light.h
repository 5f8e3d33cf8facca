// A point that shines into a cone, with a picture or without.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/light/light_bounds.h"
#include "common/math/functions.h"
#include "common/math/transform.h"

namespace pt {

/// Between 0 and 1: the share of its intensity that a spot light sends at an angle to its axis.
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

struct SpotLight {
  static constexpr LightKind kind = LightKind::spot;
  static constexpr bool has_position = true;

  PT_HD static PlainLight sample(const Light& light, const Vec3& from, float, float) {
    const DeltaLight spot = light.delta();
    PlainLight result = sample_place(light.a, light.radiance, from, [&](const Vec3& wi) {
      return spot_share(spot, -dot(spot.direction, wi));
    });
    if (light.emission_texture != no_texture) result.uv = uv(light, -result.incident.wi);
    return result;
  }

  /// Of what a spot light gives, its falloff beyond the inner angle is bounded by a cosine that is
  /// positive up to the outer one.
  static LightBounds bounds(const Light& light) {
    const DeltaLight spot = light.delta();
    LightBounds bounds = bounds_of_place(light);
    const float inner = std::acos(std::clamp(spot.cos_inner, -1.0f, 1.0f));
    const float outer = std::acos(std::clamp(spot.cos_outer, -1.0f, 1.0f));
    bounds.axis = spot.direction;
    bounds.cone = std::max(inner, outer - quarter_turn);
    bounds.emission = std::max(outer - bounds.cone, 1e-3f);
    return bounds;
  }

  /// pbrt's estimate: the cone of the mean of both angles' cosines.
  static Color power(const DeltaLight& light, float) {
    return 2.0f * pi * (1.0f - 0.5f * (light.cos_inner + light.cos_outer)) * light.intensity;
  }

  static void store(const DeltaLight& spot, Light& light) {
    if (spot.texture == no_texture) return;
    light.triangle = roll(spot);
    light.emission_texture = spot.texture;
  }

 private:
  /// How its picture is turned about the axis: the angle of `right` in the axis' frame, in turns
  /// from 0 to 1, less 1 where the picture is mirrored.
  static std::uint32_t roll(const DeltaLight& spot) {
    const Frame frame = make_frame(spot.direction);
    const float angle =
        std::atan2(glm::dot(spot.right, frame.bitangent), glm::dot(spot.right, frame.tangent));
    const float turns = angle / (2.0f * pi);
    const float positive = turns < 0.0f ? turns + 1.0f : turns;
    return float_to_bits(spot.aspect < 0.0f ? positive - 1.0f : positive);
  }

  /// Where its picture is looked up for a direction: it fills the cone of the outer angle.
  PT_HD static Vec2 uv(const Light& light, const Vec3& direction) {
    const float turns = bits_to_float(light.triangle);
    const Frame frame = make_frame(light.b);
    const SinCos roll = sincos_2pi(turns);
    const Vec3 right = roll.cos * frame.tangent + roll.sin * frame.bitangent;
    const Vec3 up = (turns < 0.0f ? -1.0f : 1.0f) * cross_rounded(right, light.b);
    const float cos_outer = light.c.x < light.c.y ? light.c.x : light.c.y;
    const float tangent = sqrtf(fmaxf(1.0f - cos_outer * cos_outer, 0.0f)) / cos_outer;
    const float scale = 0.5f / (dot(light.b, direction) * tangent);
    return {0.5f + scale * dot(right, direction), 0.5f + scale * dot(up, direction)};
  }
};

}  // namespace pt
